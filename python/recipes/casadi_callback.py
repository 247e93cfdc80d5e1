"""The residuals as a CasADi function with an exact Jacobian, minimised by IPOPT within bounds."""

from pathlib import Path

import casadi as ca
import numpy as np

import hardpoint as hp


class Jacobian(ca.Callback):
    """The Jacobian of the residuals, as CasADi asks for it."""

    def __init__(self, name, residuals, m, options):
        super().__init__()
        self.residuals, self.m = residuals, m
        self.construct(name, options)

    def get_n_in(self):
        return 2

    def get_n_out(self):
        return 1

    def get_sparsity_in(self, i):
        return ca.Sparsity.dense(len(self.residuals.variables)) if i == 0 else ca.Sparsity.dense(self.m)

    def get_sparsity_out(self, i):
        return ca.Sparsity.dense(self.m, len(self.residuals.variables))

    def eval(self, arguments):
        return [self.residuals.jacobian(np.array(arguments[0]).ravel())]


class Residuals(ca.Callback):
    """The targets of a study, in tolerances."""

    def __init__(self, study):
        super().__init__()
        self.residuals = study.residuals()
        self.m = len(self.residuals(np.zeros(len(self.residuals.variables))))
        self.construct("residuals", {})

    def get_sparsity_in(self, i):
        return ca.Sparsity.dense(len(self.residuals.variables))

    def get_sparsity_out(self, i):
        return ca.Sparsity.dense(self.m)

    def eval(self, arguments):
        return [self.residuals(np.array(arguments[0]).ravel())]

    def has_jacobian(self):
        return True

    def get_jacobian(self, name, inputs, outputs, options):
        self.jacobian_callback = Jacobian(name, self.residuals, self.m, options)
        return self.jacobian_callback


if __name__ == "__main__":
    study = hp.load(Path(__file__).resolve().parents[2] / "studies" / "macpherson_front.toml")
    residuals = Residuals(study)
    low, high = study.residuals().bounds.T
    unit = ca.MX.sym("u", len(low))
    r = residuals(unit * (high - low))
    problem = {"x": unit, "f": ca.dot(r, r) / residuals.m}
    options = {"ipopt.hessian_approximation": "limited-memory", "ipopt.print_level": 0, "print_time": False}
    solver = ca.nlpsol("solver", "ipopt", problem, options)
    found = solver(x0=np.zeros(len(low)), lbx=low / (high - low), ubx=high / (high - low))
    print(f"misfit {float(found['f']) ** 0.5:.6g}; hardpoint.optimise {hp.optimise(study).misfit:.6g}")
