//! Prints one column of the curves of an axle from a study file.
//!
//! `cargo run --example axle -- studies/macpherson_axle.toml track_mm`

use hardpoint::Study;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next();
    let path = path.unwrap_or_else(|| "studies/macpherson_axle.toml".to_owned());
    let column = arguments.next().unwrap_or_else(|| "track_mm".to_owned());
    let study = Study::read(path.as_ref(), &[])?;
    let curves = study.curves()?;
    let names: Vec<&str> = curves.columns.iter().map(|c| c.name.as_str()).collect();
    let Some(index) = names.iter().position(|name| *name == column) else {
        return Err(format!("no column {column}; there are {}", names.join(", ")).into());
    };
    for station in &curves.stations {
        match &station.values[index] {
            Ok(value) => println!("{:?}  {value:.4}", station.at),
            Err(reason) => println!("{:?}  none: {reason:?}", station.at),
        }
    }
    Ok(())
}
