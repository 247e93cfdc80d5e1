use super::*;

#[test]
fn a_point_is_a_list_or_a_table_and_its_name_the_way_to_it() {
    for text in [
        r#"{"lower arm front": [1, 2.5, -3e1]}"#,
        r#"{"lower arm": {"front": {"z": -30, "X": 1, "y": 2.5}}}"#,
        r#"[{"name": "lower arm front", "x": 1, "y": 2.5, "z": -30, "note": "?"}]"#,
        r#"{"lower": {"arm": {"front": [1, 2.5, -30]}, "inertia": [1, 2], "fixed": true}}"#,
    ] {
        let table = points_of(&of_json(text).unwrap()).unwrap().unwrap();
        let [point] = &table.points[..] else {
            panic!("{text}: {table:?}")
        };
        assert_eq!(point.name, "lower arm front", "{text}");
        assert_eq!(point.position, Ok([1.0, 2.5, -30.0]), "{text}");
    }
}

#[test]
fn repeated_keys_stay_two_points_and_what_is_no_map_is_refused() {
    let read = |text: &str| points_of(&of_json(text)?);
    let table = read(r#"{"units": "mm", "a": [1, 2, 3], "a": [1, 2, 4], "mass": 3}"#);
    let table = table.unwrap().unwrap();
    assert_eq!((table.points.len(), table.figures.len()), (2, 1));
    assert_eq!(table.unit, FileUnit::named("mm"));
    assert_eq!(read("{}").unwrap(), None);
    assert_eq!(read("[1, 2]").unwrap(), None);
    let deep = "[".repeat(100_000);
    for wrong in [
        "{",
        "{\"a\": [1, 2, 1e999]}",
        r#"{"unit": "furlong"}"#,
        &deep,
    ] {
        assert!(read(wrong).is_err());
    }
}

/// A point with remarks is a point. Its entries give the wheel, the axle and the unit.
#[test]
fn entries_of_a_point_give_its_wheel_and_unit() {
    let read = |text: &str| points_of(&of_json(text)?).map(|table| table.unwrap_or_default());
    for text in [
        r#"[{"name": "LBJ", "side": "right", "axle": "rear", "unit": "in", "x": 1, "y": 2, "z": 3}]"#,
        r#"{"LBJ": {"x": 1, "y": 2, "z": 3, "Corner": "RR", "unit": "in", "note": "measured"}}"#,
    ] {
        let table = read(text).unwrap();
        let [point] = &table.points[..] else {
            panic!("{text}: {table:?}")
        };
        assert_eq!(point.position, Ok([1.0, 2.0, 3.0]), "{text}");
        let marks = marks_of("rr");
        assert_eq!((point.marks, point.mirrored), (marks, false), "{text}");
        assert_eq!(table.unit, FileUnit::named("in"), "{text}");
    }
    let both = read(r#"{"LBJ": {"x": 1, "y": 2, "z": 3, "side": "left/right"}}"#).unwrap();
    assert!(both.points[0].mirrored);
    assert!(read(r#"{"LBJ": {"x": 1, "y": 2, "z": 3, "side": "middle"}}"#).is_err());
}

/// A hardpoint with a value that is not a number has a reason, so that it is not reported as missing.
#[test]
fn coordinates_that_are_no_numbers_are_named() {
    let read = |text: &str| points_of(&of_json(text).unwrap()).unwrap();
    for text in [
        r#"{"spring_upper": [1, null, 3]}"#,
        r#"{"spring_upper": ["1", "2", "3"]}"#,
        r#"{"spring_upper": {"x": 1, "y": "2,5", "z": 3}}"#,
        r#"[{"name": "spring_upper", "x": 1, "y": null, "z": 3}]"#,
    ] {
        let table = read(text).unwrap();
        let reason = table.points[0].position.clone().unwrap_err();
        assert!(reason.contains("spring_upper"), "{text}: {reason}");
        assert!(
            reason.contains("expected three numbers"),
            "{text}: {reason}"
        );
    }
    // Other names are not points.
    assert_eq!(
        read(r#"{"colour": ["1", "2", "3"], "rates": [1, null, 3]}"#),
        None
    );
}
