use super::*;
use crate::exchange::delimited;
use crate::model::{FrameConvention, LengthUnit, Side};

fn table(text: &str) -> PointTable {
    read(&delimited::read(text).unwrap()).unwrap().unwrap()
}

fn refusal(text: &str) -> String {
    read(&delimited::read(text).unwrap()).unwrap_err()
}

fn position(table: &PointTable, number: usize) -> [f64; 3] {
    table.points[number].position.clone().unwrap()
}

#[test]
fn columns_stand_in_any_order() {
    let read = table("remark,Z [in],X [in],Y [in],Point\nok,3,1,2.5,lca_front\n");
    assert_eq!(position(&read, 0), [1.0, 2.5, 3.0]);
    assert_eq!(
        (read.points[0].name.as_str(), read.unit),
        ("lca_front", Some(FileUnit::of(LengthUnit::Inch)))
    );
}

#[test]
fn a_table_may_have_no_header() {
    let read = table("a,1,2,3\nb,4,5,6\n");
    assert_eq!(
        (position(&read, 1), read.notes.texts().count()),
        ([4.0, 5.0, 6.0], 1)
    );
}

#[test]
fn sides_stand_in_columns_titles_and_headers() {
    let by_column = table("name,side,x,y,z\nlbj,left,1,2,3\nlbj,R,1,-2,3\n");
    let by_title = table("name,x,y,z\nLeft wheel\nlbj,1,2,3\nRight wheel\nlbj,1,-2,3\n");
    let by_header = table(",Left,,,Right,,\nname,x,y,z,x,y,z\nlbj,1,2,3,1,-2,3\n");
    for read in [by_column, by_title, by_header] {
        let sides: Vec<_> = read.points.iter().map(|point| point.marks.side).collect();
        assert_eq!(sides, [Some(Side::Left), Some(Side::Right)], "{read:?}");
        assert_eq!(position(&read, 1), [1.0, -2.0, 3.0]);
    }
}

/// A title may describe the axes. Its commas then split it into cells, and its word "right" is a direction, not a wheel. This
/// also applies to a title in comments.
#[test]
fn directions_in_a_title_name_no_wheel() {
    let title = "front suspension, LEFT side\nSAE axes: x fwd, y right, z down. All dims inches\n";
    let rows = "name,x,y,z\nlbj,0.2,-23.4,5.3\n";
    let comments = title.lines().map(|line| format!("# {line}\n"));
    let in_comments = comments.collect::<String>();
    for above in [title, &in_comments] {
        let read = table(&format!("{above}{rows}"));
        assert_eq!(read.points[0].marks.side, Some(Side::Left), "{above}");
        assert_eq!(read.unit, Some(FileUnit::of(LengthUnit::Inch)), "{above}");
        let axes = read.declared.axes().and_then(|axes| axes.convention());
        assert_eq!(axes, Some(FrameConvention::SaeJ670), "{above}");
    }
}

/// A car's sheet has one set of columns for each corner. The corner is part of each column name, or a title above its columns.
#[test]
fn a_set_of_columns_for_each_corner() {
    use crate::model::AxlePosition::{Front, Rear};
    let by_header = table("name,FL X,FL Y,FL Z,RL X,RL Y,RL Z\nlbj,1,2,3,-4,2,3\n");
    let by_title = table(",FL,,,RL,,\nname,x,y,z,x,y,z\nlbj,1,2,3,-4,2,3\n");
    for read in [by_header, by_title] {
        let marks = read
            .points
            .iter()
            .map(|point| (point.marks.side, point.marks.axle));
        let left = Some(Side::Left);
        assert_eq!(
            marks.collect::<Vec<_>>(),
            [(left, Some(Front)), (left, Some(Rear))]
        );
        assert_eq!(position(&read, 1), [-4.0, 2.0, 3.0]);
    }
    let stated = table("units mm,origin,\nname,x,y,z\nlbj,1,2,3\n");
    assert_eq!(stated.unit, Some(FileUnit::of(LengthUnit::Millimetre)));
}

#[test]
fn decimal_commas_are_read_where_they_are_certain() {
    let read = table("name;x;y;z\na;120,5;360,25;-0,5\n");
    assert_eq!(position(&read, 0), [120.5, 360.25, -0.5]);
    // All numbers have three decimals, so the comma is a decimal comma.
    assert_eq!(
        position(&table("n;x;y;z\na;1,250;0,500;0,000\n"), 0),
        [1.25, 0.5, 0.0]
    );
    assert!(refusal("name;x;y;z\na;120,5;360.25;1\n").contains("commas and points are mixed"));
    assert!(
        refusal("name;x;y;z\na;1,250;360;1\n")
            .contains("may be a decimal sign or separate thousands")
    );
}

#[test]
fn what_is_no_number_is_named_with_its_place() {
    let read = table("name,x,y,z\na,1,2,3\nb,1,,3\nc,1,inf,3\nd,1,2 s,3\n");
    let fault = |n: usize| read.points[n].position.clone().unwrap_err();
    assert_eq!(fault(1), "line 3, column 3: the cell is empty");
    assert_eq!(
        fault(2),
        "line 4, column 3: expected a number, found \"inf\""
    );
    assert!(fault(3).contains("found \"2 s\""));
}

/// Coordinates may have their unit in the same cell. It must be the same for all coordinates and the same as in the header.
#[test]
fn units_after_coordinates_are_read() {
    let read = table("name,x,y,z\na,20 cm,-3.5cm,0\nb,1 cm,2 cm,3 cm\nradius of wheel,310 mm,,\n");
    assert_eq!(read.unit, FileUnit::named("cm"));
    assert_eq!(position(&read, 0), [20.0, -3.5, 0.0]);
    let radius = &read.figures[0];
    assert_eq!(
        (radius.value, &radius.read_as[..]),
        (310.0, "radius of wheel [mm]")
    );
    let commas = table("name;x;y;z\na;20,5 mm;3,25 mm;1 mm\n");
    assert_eq!(position(&commas, 0), [20.5, 3.25, 1.0]);
    for (text, phrase) in [
        (
            "name,x,y,z\na,1 mm,2 mm,3\n",
            "line 2, column 4 has no unit",
        ),
        ("name,x,y,z\na,1 mm,2 mm,3 in\n", "is marked as inches"),
        (
            "name,x,y,z\na,1,2,3\nradius,3,,\nb,1 m,2,3\n",
            "is marked as m",
        ),
        (
            "name,x [in],y,z\na,1 mm,2 mm,3 mm\n",
            "the header states inches",
        ),
    ] {
        assert!(refusal(text).contains(phrase), "{}", refusal(text));
    }
}

/// Each header applies to the numbers below it, so all of them decide on the decimal sign.
#[test]
fn decimal_signs_of_all_blocks_are_compared() {
    let head = "name;x;y;z;;;;\n";
    let below = ";;;;name;x;y;z\n;;;;b;4.5;5;6\n";
    let refused = refusal(&format!("{head}a;1,5;2;3;;;;\n{below}"));
    assert!(refused.contains("commas and points are mixed"), "{refused}");
    let read = table(&format!("{head}a;1.5;2;3;;;;\n{below}"));
    assert_eq!(position(&read, 0), [1.5, 2.0, 3.0]);
    assert_eq!(position(&read, 1), [4.5, 5.0, 6.0]);
}

/// A minus in a header may be a sign or a dash. A warning says that it is not used.
#[test]
fn unused_signs_of_headers_are_reported() {
    let doubts = |head: &str| {
        let notes = table(&format!("{head}\na,1,2,3\n")).notes;
        notes.doubts().collect::<Vec<_>>().join("\n")
    };
    for head in [
        "name,-x,y,z",
        "name,x (-forward),y (left),z (up)",
        "name,x - forward,y left,z up",
        "name,x,y (right -),z",
        "name,negative x,y,z",
    ] {
        assert!(doubts(head).contains("line 1: the minus in"), "{head}");
    }
    for head in [
        "name,x - mm,y - mm,z - mm",
        "name,x,y (right +),z",
        "name,x-value,y,z",
    ] {
        assert_eq!(doubts(head), "", "{head}");
    }
    let doubt = doubts("name,negative x,y,z");
    assert!(doubt.contains("\"negative x\""), "{doubt}");
}

#[test]
fn figures_stand_among_points() {
    let read = table("name,x,y,z\na,1,2,3\nwheel radius,300,,\nstatic_camber,-0.5,,\n");
    let figures: Vec<f64> = read.figures.iter().map(|figure| figure.value).collect();
    assert_eq!((figures, read.points.len()), (vec![300.0, -0.5], 1));
}

/// Values are in the first column, and their units in the next cell, while names of points are in the second column.
#[test]
fn figures_in_the_first_column_keep_their_units() {
    let read = table(
        "Ref,Description,X,Y,Z\nP1,a,1,2,3\nStatic camber,,-1.5,deg,\nTyre radius,,10.3,in,\n",
    );
    let figures: Vec<(&str, f64)> = read
        .figures
        .iter()
        .map(|f| (&f.read_as[..], f.value))
        .collect();
    let wanted = [("Static camber [deg]", -1.5), ("Tyre radius [in]", 10.3)];
    assert_eq!((figures.as_slice(), read.points.len()), (&wanted[..], 1));
}

#[test]
fn commas_between_and_inside_of_numbers_are_refused() {
    let refused = refusal("name,x,y,z\na,110,5,240,0,290,2\nb,1,0,2,5,3,0\n");
    assert!(
        refused.contains("separate the cells by semicolons"),
        "{refused}"
    );
    // A comma between groups of digits shifts the numbers of one row.
    let refused = refusal("name,x,y,z\na,110,5,240\nb,1,130.5,385,225\nc,90,5,240\n");
    assert!(refused.contains("groups the digits"), "{refused}");
    // A sheet may have further numbers beside the points, in a column with or without a title.
    assert_eq!(table("name,x,y,z,mass\na,110,5,240,3\n").points.len(), 1);
    assert_eq!(table("name,x,y,z\na,110,5,240,3\n").points.len(), 1);
}

#[test]
fn contradictions_are_refused() {
    assert!(refusal("name,x [mm],y [in],z\na,1,2,3\n").contains("different units"));
    assert!(refusal("name,x,y,z,x,y,z\na,1,2,3,4,5,6\n").contains("2 sets of x, y and z"));
    let twice = "name,FL x,FL y,FL z,FL x,FL y,FL z\na,1,2,3,4,5,6\n";
    assert!(refusal(twice).contains("one for each wheel"));
}

/// A row of units below the header, or a line with the key "unit" anywhere, states the unit of all coordinates.
#[test]
fn units_below_the_header_are_read_and_may_not_differ() {
    let rows = "a,1,2,3\nb,4,5,6\n";
    let inch = Some(FileUnit::of(LengthUnit::Inch));
    for text in [
        format!("name,x,y,z\nunit,in,in,in\n{rows}"),
        format!("name,x,y,z\nunits,in,,\n{rows}"),
        format!("name,x,y,z\n{rows}Units: inches\n"),
        format!("name,x,y,z\n{rows}All dimensions in inches\n"),
    ] {
        let read = table(&text);
        assert_eq!((read.unit, read.points.len()), (inch, 2), "{text}");
    }
    assert_eq!(
        table(&format!("name,x,y,z\n{rows}Units: N/mm\n")).unit,
        None
    );
    for text in [
        format!("name,x,y,z\n,mm,mm,in\n{rows}"),
        format!("name,x [mm],y [mm],z [mm]\n{rows}Units: inches\n"),
    ] {
        assert!(
            refusal(&text).contains("differs from the unit above"),
            "{text}"
        );
    }
}

#[test]
fn rows_without_a_name_are_listed() {
    let read = table("name,x,y,z\na,1,2,3\n,4,5,6\n,7,8,9\n,,,1\n");
    assert_eq!(read.points.len(), 1);
    assert_eq!(
        read.left_out,
        ["line 3 and 1 more: coordinates without a name"]
    );
}

/// A value of the wheel above the header that cannot be read is listed.
#[test]
fn unreadable_values_above_the_header_are_listed() {
    let read = table("Loaded radius,about 310\nTrack\nname,x,y,z\na,1,2,3\n");
    let line = "Loaded radius (line 1): expected one number in a cell of its own";
    assert_eq!(
        (read.figures.len(), read.left_out),
        (0, vec![line.to_owned()])
    );
}

/// Tables side by side may have their own columns of names. If the names differ, their rows belong to different points.
#[test]
fn different_names_side_by_side_are_refused() {
    let head = ",FL,,,,FR,,\nname,x,y,z,name,x,y,z\n";
    let same = table(&format!("{head}a,1,2,3,A,1,-2,3\n"));
    assert_eq!(same.points.len(), 2);
    let refused = refusal(&format!("{head}a,1,2,3,b,4,-5,6\nb,4,5,6,a,1,-2,3\n"));
    assert!(
        refused.starts_with("line 3: this row has different points"),
        "{refused}"
    );
}

/// The lines above a table without a header state its unit, its axes and its wheel.
#[test]
fn lines_above_a_table_without_a_header_are_read() {
    let rows = "a 1 2 3\nb 4 5 6\n";
    let read = table(&format!("# right side, in cm\nSAE axes\n{rows}"));
    assert_eq!(read.unit, FileUnit::named("cm"));
    let axes = read.declared.axes().and_then(|axes| axes.convention());
    assert_eq!(axes, Some(FrameConvention::SaeJ670));
    let sides: Vec<_> = read.points.iter().map(|point| point.marks.side).collect();
    assert_eq!(sides, [Some(Side::Right); 2]);
    let read = table(&format!("unit: parsec\n{}", rows.replace(' ', ",")));
    assert!(
        read.unknown_unit
            .is_some_and(|unit| unit.contains("parsec"))
    );
}
