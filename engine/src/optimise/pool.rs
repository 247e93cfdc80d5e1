//! Pool of problems for repeated use. Making a problem takes as long as evaluating it several times.

use super::{Assessment, Constrained, Infeasible, LeastSquares, Linearisation, Shape};
use nalgebra::DVector;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Problems that are idle at the moment.
pub(super) struct Pool<P>(Mutex<Vec<P>>);

impl<P> Pool<P> {
    /// Makes a pool of these problems.
    pub(super) fn of(idle: impl IntoIterator<Item = P>) -> Self {
        Pool(Mutex::new(Vec::from_iter(idle)))
    }

    /// Lends a problem of the pool, or makes a new one. The problem returns to the pool when its guard is dropped. Results
    /// depend only on the evaluated point, so the pool may lend any of its problems.
    pub(super) fn lend(&self, make: impl FnOnce() -> P) -> PoolGuard<'_, P> {
        let idle = self.idle().pop();
        PoolGuard {
            pool: self,
            problem: Some(idle.unwrap_or_else(make)),
        }
    }

    fn idle(&self) -> MutexGuard<'_, Vec<P>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Guard of a lent problem. When the guard is dropped, it returns the problem to its pool.
pub(super) struct PoolGuard<'p, P> {
    pool: &'p Pool<P>,
    problem: Option<P>,
}

impl<P> PoolGuard<'_, P> {
    fn get(&self) -> &P {
        self.problem
            .as_ref()
            .expect("the guard holds its problem object until the guard is dropped")
    }

    /// The lent problem.
    pub(super) fn get_mut(&mut self) -> &mut P {
        self.problem
            .as_mut()
            .expect("the guard holds its problem object until the guard is dropped")
    }
}

impl<P> Drop for PoolGuard<'_, P> {
    fn drop(&mut self) {
        // After a panic the evaluation of the problem may be incomplete, so the problem is dropped.
        if !std::thread::panicking() {
            self.pool.idle().extend(self.problem.take());
        }
    }
}

impl<P: LeastSquares> LeastSquares for PoolGuard<'_, P> {
    fn variables(&self) -> usize {
        self.get().variables()
    }

    fn residuals(&self) -> usize {
        self.get().residuals()
    }

    fn evaluate(&mut self, x: &DVector<f64>, into: &mut Linearisation) -> Result<(), Infeasible> {
        self.get_mut().evaluate(x, into)
    }
}

impl<P: Constrained> Constrained for PoolGuard<'_, P> {
    fn shape(&self) -> Shape {
        self.get().shape()
    }

    fn row_limits(&self) -> Vec<f64> {
        self.get().row_limits()
    }

    fn assess(&mut self, x: &DVector<f64>, into: &mut Assessment) -> Result<(), Infeasible> {
        self.get_mut().assess(x, into)
    }
}
