//! Tunes a study file with constraints: prints the moves, and the margin of each constraint.
//!
//! `cargo run --example tuning`

use hardpoint::{Control, Study};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1);
    let path = path.unwrap_or_else(|| "studies/formula_student_front.toml".to_owned());
    // One start is enough for an example; the study has four.
    let study = Study::read(path.as_ref(), &["optimise.starts=1".to_owned()])?;
    let tuning = study.tune(Control::default())?;
    let before = tuning.before.as_ref().map_err(ToString::to_string)?;
    let best = tuning.best.as_ref().ok_or("no start can be solved")?;
    let (from, to) = (before.misfit, best.after.misfit);
    println!("misfit {from:.2} -> {to:.2} tolerances");
    let asked = study.optimise.as_ref().ok_or("the study tunes nothing")?;
    for (variable, offset) in asked.variables.iter().zip(&best.offsets) {
        println!("{:24} {offset:+.3}", variable.label());
    }
    for (constraint, outcome) in asked.constraints.iter().zip(&best.constraints) {
        println!("margin {:8.3}  {}", outcome.margin, constraint.name);
    }
    Ok(())
}
