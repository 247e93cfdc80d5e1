"""A tuning with SciPy: `least_squares` takes the targets of the study, in tolerances, and their exact Jacobian."""

from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

import hardpoint as hp

STUDY = Path(__file__).resolve().parents[2] / "studies" / "macpherson_front.toml"


def tuned(study: hp.Study):
    """What SciPy finds: `.x` are the offsets of the variables."""
    r = study.residuals()
    # The variables are of different sizes: steps are measured by their ranges.
    return least_squares(r, np.zeros(len(r.variables)), jac=r.jacobian, bounds=r.bounds.T, x_scale=np.ptp(r.bounds, axis=1))


if __name__ == "__main__":
    study = hp.load(STUDY)
    fit = tuned(study)
    # The nearest design that is good enough is another question than the least misfit: ask for the least.
    least = hp.optimise(study.replace({"optimise.good_enough": 0.0}))
    misfit = np.sqrt(np.mean(fit.fun**2))
    np.testing.assert_allclose(misfit, least.misfit, rtol=1e-6)
    print(f"misfit {misfit:.6g} after {fit.nfev} evaluations; hardpoint.optimise {least.misfit:.6g}")
    for name, offset in zip(study.residuals().variables, fit.x):
        print(f"  {name:20} {offset:+8.3f} {study.length_unit}")
