//! Tests of the schema.

use super::schema;
use serde_json::json;

#[test]
fn keys_types_and_needs_are_those_of_the_reader() {
    let schema = schema(|_, _| None);
    let car = &schema["anyOf"][1];
    assert_eq!(car["required"], json!(["car"]));
    assert_eq!(
        car["properties"]["car"]["required"],
        json!(["front", "rear"])
    );
    let case = &car["properties"]["cases"]["items"];
    assert_eq!(case["required"], json!(["name"]));
    assert_eq!(
        case["properties"]["ay"]["description"],
        "acceleration to the left (a left turn), g"
    );
    // Keys that only the study of a car has.
    let target = "/properties/optimise/properties/targets/items/properties";
    let offers = |kind: usize, key: &str| {
        let keys = schema["anyOf"][kind].pointer(target).unwrap();
        keys.get(key).is_some()
    };
    for key in ["case", "axle"] {
        assert!(offers(1, key) && !offers(0, key), "{key}");
    }
    let schema = &schema["anyOf"][0];
    let at = |pointer: &str| {
        schema
            .pointer(pointer)
            .unwrap_or_else(|| panic!("{pointer}: {schema:#}"))
    };
    assert_eq!(at("/required"), &json!(["suspension", "motion"]));
    assert_eq!(at("/additionalProperties"), &json!(false));
    assert_eq!(
        at("/properties/suspension/required"),
        &json!(["topology", "hardpoints"])
    );
    let coordinates = "/properties/suspension/properties/hardpoints/additionalProperties";
    assert_eq!(
        at(coordinates),
        &json!({ "type": "array", "items": { "type": "number" } })
    );
    let travel = at("/properties/motion/properties/travel/anyOf");
    assert_eq!(travel.as_array().unwrap().len(), 3, "{travel}");
    assert_eq!(travel[2]["required"], json!(["from", "to", "steps"]));
    assert_eq!(travel[2]["properties"]["steps"]["type"], "integer");
    let sensitivities = at("/properties/outputs/properties/sensitivities/anyOf");
    assert_eq!(sensitivities[0]["type"], "boolean");
    assert_eq!(sensitivities[1]["items"]["type"], "string");
    let tolerance = "/properties/optimise/properties/targets/items/properties/tolerance";
    assert_eq!(at(tolerance)["description"], "acceptable deviation");
}
