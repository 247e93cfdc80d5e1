//! Studies that `hardpoint new` writes for a car.

/// Template for a car: the name of the template, then the name and the text of each study file.
pub type CarTemplate = (&'static str, [(&'static str, &'static str); 3]);

/// All templates for cars.
pub const TEMPLATES: [CarTemplate; 2] = [
    (
        "car",
        [
            ("car.toml", include_str!("../../templates/car.toml")),
            (
                "car_front.toml",
                include_str!("../../templates/car_front.toml"),
            ),
            (
                "car_rear.toml",
                include_str!("../../templates/car_rear.toml"),
            ),
        ],
    ),
    (
        "formula_student_car",
        [
            (
                "formula_student_car.toml",
                include_str!("../../templates/formula_student_car.toml"),
            ),
            (
                "formula_student_car_front.toml",
                include_str!("../../templates/formula_student_car_front.toml"),
            ),
            (
                "formula_student_car_rear.toml",
                include_str!("../../templates/formula_student_car_rear.toml"),
            ),
        ],
    ),
];
