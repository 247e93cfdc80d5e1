//! Worker of one CPU thread, which solves blocks of designs and writes their rows.

use super::*;

/// Worker that solves blocks of designs and writes their rows. Each CPU thread has one worker.
pub struct Worker<'p> {
    pub(super) plan: &'p SweepPlan<'p>,
    pub(super) evaluator: Evaluator<'p>,
    pub(super) block: Block,
    pub(super) designs: Vec<Vector3<f64>>,
    /// Rates of elastic parts that the sweep varies, design after design.
    pub(super) rates: Vec<f64>,
    /// Assessor of the targets whose stations are not stations of the sweep, and of all constraints. `None` if there are
    /// none.
    pub(super) goals: Option<GoalAssessor<'p>>,
    pub(super) rows: Rows,
}

impl Worker<'_> {
    /// Computes the rows of a block of the sweep.
    pub fn rows(&mut self, block: u64) -> &Rows {
        let SweepPlan {
            record,
            samples,
            study,
            ..
        } = self.plan;
        let Suspension { design, frame, .. } = study.wheel();
        let range = record.designs_of(block);
        let (count, width) = ((range.end - range.start) as usize, record.variables.len());
        let rows = &mut self.rows;
        self.rates.clear();
        rows.first = range.start;
        rows.variables.resize(count * width, 0.0);
        self.designs
            .resize(count * design.len(), Vector3::default());
        for ((number, values), moved) in range
            .zip(rows.variables.chunks_exact_mut(width))
            .zip(self.designs.chunks_exact_mut(design.len()))
        {
            samples.values(number, values);
            samples.place(values, frame, design, moved);
            samples.append_rates(values, &mut self.rates);
            for value in values {
                *value += 0.0;
            }
        }
        self.evaluate();
        &self.rows
    }

    /// Indices of the designs of the last block that were solved one by one, in order.
    pub fn one_by_one(&self) -> &[usize] {
        self.evaluator.one_by_one()
    }

    /// Reason why no design is solved in SIMD lanes. `None` if lanes are in use.
    pub fn not_in_lanes(&self) -> Option<NotInLanes> {
        self.evaluator.not_in_lanes()
    }

    /// Values of the quantities from which the latest rows were made.
    pub fn block(&self) -> &Block {
        &self.block
    }

    /// Evaluates the designs and writes their rows.
    fn evaluate(&mut self) {
        let (plan, rows) = (self.plan, &mut self.rows);
        self.evaluator.set_rates(&self.rates);
        self.evaluator.evaluate(&self.designs, &mut self.block);
        let width = plan.record.outputs.len();
        rows.outputs.resize(self.block.designs() * width, f64::NAN);
        plan.failing(&self.block, &mut rows.failing);
        let points = self.designs.len() / self.block.designs().max(1);
        let rates = self.rates.len() / self.block.designs().max(1);
        for (k, outputs) in rows.outputs.chunks_exact_mut(width).enumerate() {
            let failing = &mut rows.failing[k];
            let goals = self.goals.as_mut().map(|goals| {
                let design = &self.designs[k * points..][..points];
                let is_degenerate = self.block.faults().iter().any(|(own, _)| *own == k);
                let design = (!is_degenerate).then_some(design);
                let (values, reason) = goals.assess(design, &self.rates[k * rates..][..rates]);
                *failing = failing.take().or(reason);
                values
            });
            plan.summarise(&self.block, k, goals, outputs);
        }
    }

    /// Computes the outputs of one design, given by its points in the kernel's frame.
    pub(super) fn row_of(&mut self, design: &[Vector3<f64>]) -> Vec<f64> {
        self.designs.clear();
        self.designs.extend_from_slice(design);
        self.rates.clear();
        let rates = self.plan.samples.rates().map(|rate| rate.design);
        self.rates.extend(rates);
        self.evaluate();
        self.rows.outputs.clone()
    }
}
