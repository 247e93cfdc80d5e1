"""Optuna where it belongs and where it does not.

A sampler that knows no gradient is for what has none: which of several layouts, how many, yes or no. Here it chooses
between two places of the rack and lets the least-squares method tune the coordinates of each: a handful of trials.
Beside it, the same sampler alone on the coordinates.
"""

from pathlib import Path

import numpy as np
import optuna

import hardpoint as hp

STUDY = Path(__file__).resolve().parents[2] / "studies" / "macpherson_front.toml"
TRIALS = 40


def chosen(study: hp.Study, trials: int) -> optuna.Study:
    """A choice that no derivative reaches, each tuned by what knows derivatives."""
    def misfit(trial: optuna.Trial) -> float:
        shift = [trial.suggest_categorical("rack_shifted_by", [-20.0, -10.0, 0.0, 10.0]), 0.0, 0.0]
        points = {name: study[name] + shift for name in ("tie_rod_inner", "tie_rod_outer")}
        return hp.optimise(study.replace(points=points), threads=1).misfit

    search = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=1))
    search.optimize(misfit, n_trials=trials)
    return search


def sampled(study: hp.Study, trials: int) -> optuna.Study:
    """The coordinates themselves by sampling: not what it is for."""
    r = study.residuals()

    def misfit(trial: optuna.Trial) -> float:
        x = [trial.suggest_float(name, low, high) for name, (low, high) in zip(r.variables, r.bounds)]
        misfit = float(np.sqrt(np.mean(r(x) ** 2)))
        if np.isnan(misfit):  # the design cannot be assembled over the whole motion
            raise optuna.TrialPruned
        return misfit

    search = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=1))
    search.optimize(misfit, n_trials=trials)
    return search


if __name__ == "__main__":
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    study = hp.load(STUDY)
    best = chosen(study, 6)
    alone = sampled(study, TRIALS)
    exact = hp.optimise(study).misfit
    assert alone.best_value > exact
    print(f"misfit {best.best_value:.3g} with {best.best_params} after 6 trials, each tuned with derivatives;")
    print(f"  by sampling coordinates {alone.best_value:.3g} after {TRIALS}, where hardpoint.optimise finds {exact:.3g}")
