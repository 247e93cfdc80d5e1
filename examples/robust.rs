//! Runs a robust tuning with 4, 16 and 64 random builds, which have the tolerances of `[tolerance]`. Prints the misfit of the
//! builds before and after the tuning, and the moves of the variables.
//!
//! `cargo run --example robust`

use hardpoint::{Control, Study};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1);
    let path = path.unwrap_or_else(|| "studies/double_wishbone_robust.toml".to_owned());
    for builds in [4, 16, 64] {
        let study = Study::read(path.as_ref(), &[format!("optimise.scatter={builds}")])?;
        let tuning = study.tune(Control::default())?;
        let before = tuning.before.as_ref().map_err(ToString::to_string)?;
        let best = tuning.best.as_ref().ok_or("no start can be solved")?;
        let offsets: Vec<String> = best.offsets.iter().map(|o| format!("{o:+.2}")).collect();
        println!(
            "{builds:3} builds: rms misfit {:.3} -> {:.3} tolerances, moves {}",
            before.misfit,
            best.after.misfit,
            offsets.join(" ")
        );
    }
    Ok(())
}
