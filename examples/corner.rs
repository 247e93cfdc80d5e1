//! Builds one corner from numbers in the code. Prints its design position, and toe and camber at three travels.
//!
//! `cargo run --example corner`

use hardpoint::{Characteristic, Suspension};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let suspension = Suspension::builder("double_wishbone")
        .hardpoint("upper_arm_front", [110.0, 240.0, 290.0])
        .hardpoint("upper_arm_rear", [-120.0, 240.0, 285.0])
        .hardpoint("upper_ball_joint", [-8.0, 548.0, 330.0])
        .hardpoint("lower_arm_front", [120.0, 160.0, 115.0])
        .hardpoint("lower_arm_rear", [-140.0, 160.0, 115.0])
        .hardpoint("lower_ball_joint", [3.0, 572.0, 125.0])
        .hardpoint("tie_rod_inner", [70.0, 190.0, 143.0])
        .hardpoint("tie_rod_outer", [60.0, 565.0, 150.0])
        .hardpoint("wheel_centre", [0.0, 600.0, 228.0])
        .static_angles_deg(-1.5, 0.0)
        .build()?;
    println!("travel_mm  camber_deg  toe_deg  lower ball joint");
    for travel in [-30.0, 0.0, 30.0] {
        let pose = suspension.pose_at(travel, 0.0)?;
        let value = |of| pose.characteristic(of).ok_or("not defined there");
        let [x, y, z] = pose.point("lower_ball_joint").ok_or("no such point")?;
        let (camber, toe) = (value(Characteristic::Camber)?, value(Characteristic::Toe)?);
        println!("{travel:9.1}  {camber:10.4}  {toe:7.4}  {x:.2} {y:.2} {z:.2}");
    }
    Ok(())
}
