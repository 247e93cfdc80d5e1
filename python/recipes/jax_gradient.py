"""The misfit as a JAX function with an exact gradient: `custom_jvp` over `pure_callback`."""

from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

import hardpoint as hp

jax.config.update("jax_enable_x64", True)


def misfit_of(study: hp.Study):
    """The mean squared residual as a function that JAX can jit and differentiate."""
    residuals = study.residuals()
    m, k = residuals.value_and_jacobian(np.zeros(len(residuals.variables)))[1].shape
    shapes = (jax.ShapeDtypeStruct((m,), jnp.float64), jax.ShapeDtypeStruct((m, k), jnp.float64))

    def both(x):
        return jax.pure_callback(lambda x: residuals.value_and_jacobian(np.asarray(x)), shapes, x)

    @jax.custom_jvp
    def r(x):
        return both(x)[0]

    @r.defjvp
    def r_jvp(primals, tangents):
        values, jacobian = both(primals[0])
        return values, jacobian @ tangents[0]

    return lambda x: jnp.mean(r(x) ** 2)


if __name__ == "__main__":
    study = hp.load(Path(__file__).resolve().parents[2] / "studies" / "macpherson_front.toml")
    misfit = misfit_of(study)
    x = jnp.zeros(len(study.residuals().variables))
    value, gradient = jax.jit(jax.value_and_grad(misfit))(x)
    values, jacobian = study.residuals().value_and_jacobian(np.zeros(len(x)))
    exact = 2 / len(values) * jacobian.T @ values
    np.testing.assert_allclose(gradient, exact, rtol=1e-12, atol=1e-12)
    print(f"mean squared misfit {value:.6g}, gradient as J'r")
