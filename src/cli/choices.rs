//! Alternatives to the tuned design, if requested: the Pareto front and the list of misfit against size of change.

use super::exit::Stop;
use super::interrupt;
use super::output::Output;
use crate::mechanism::DesignFault;
use crate::optimise::{Choice, Control, Front, Tuning, front, price_list};
use crate::report::{TuningSummary, counted, front_csv, front_remarks, front_table};
use crate::study::{Optimise, Study};

pub(super) struct Choices {
    pub front: Option<Front>,
    pub prices: Vec<Choice>,
}

impl Choices {
    /// Computes the requested alternatives after the end of a tuning: the Pareto front, and the list of misfit against size of
    /// change.
    pub(super) fn of(
        study: &Study,
        optimise: &Optimise,
        tuning: &Tuning,
        prices: bool,
    ) -> Result<Self, DesignFault> {
        let control = Control {
            interrupt: Some(interrupt::flag()),
            watch: None,
        };
        let has_best = tuning.best.is_some() && !interrupt::is_raised();
        let front = (has_best && !optimise.front.is_empty())
            .then(|| front(&study.vehicle, optimise, tuning, control));
        let prices = if has_best && prices && !optimise.fit {
            price_list(&study.vehicle, optimise, tuning, control)?
        } else {
            Vec::new()
        };
        Ok(Choices {
            front: front.transpose()?,
            prices,
        })
    }

    /// Writes `front.csv` if there is a Pareto front. Returns the name of the file.
    pub(super) fn write(
        &self,
        output: &Output,
        study: &Study,
        optimise: &Optimise,
    ) -> Result<Option<&'static str>, Stop> {
        let front = self.front.as_ref();
        let csv = front.map(|front| front_csv(study, optimise, front));
        output.file_if_any("front.csv", csv)
    }

    /// Prints the Pareto front and the list of misfit against size of change. Returns false if the front contains no design.
    pub(super) fn say(
        &self,
        output: &Output,
        optimise: &Optimise,
        summary: &TuningSummary,
    ) -> Result<bool, Stop> {
        if let Some(front) = &self.front {
            let names = optimise.front.iter().map(|goal| goal.name.as_str());
            output.say(&format!(
                "\nTrade-off between {}: {}, none better in every target (misfits in multiples of the tolerance)\n\n",
                names.collect::<Vec<_>>().join(" and "),
                counted(front.choices.len(), "design")
            ))?;
            output.table("front", &front_table(optimise, front))?;
            output.say_remarks(front_remarks(optimise, front))?;
        }
        if let Some(table) = summary.prices_table() {
            output.text_only(
                "\nSmallest misfit by the size of the change (1 = full ranges), and its decrease if \
                 the change grows by a tenth of the ranges\n\n",
            )?;
            output.table("prices", &table)?;
        }
        Ok(self
            .front
            .as_ref()
            .is_none_or(|front| !front.choices.is_empty()))
    }
}
