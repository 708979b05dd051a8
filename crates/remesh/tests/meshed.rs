//! Designs whose cut is known, meshed by Gmsh and solved.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common::{BAR, Place, cost_of, has_gmsh, with};
use nastic_language::schema::Command;
use nastic_mesh::Mesh;

/// The stretch of the whole bar of one material.
fn whole(case: &str) -> f64 {
    let place = Place::of(Command::Optimize, BAR);
    let design = r#""design": [ { "name": "rho", "kind": "density", "least": 0.01 } ]"#;
    let case = with(case, &format!(",\n                     {design}"), "");
    let (head, tail) = (case.find("\"controls\"").unwrap(), case.find("\"costs\"").unwrap());
    let case = with(&format!("{}{}", &case[..head], &case[tail..]), r#", { "kind": "greyness", "of": "rho" }"#, "");
    place.run(Command::Solve, "whole.json", &case).result["cost"]["total"].as_f64().unwrap()
}

#[test]
fn half_a_bar_is_drawn_as_far_as_a_whole_one() {
    if !has_gmsh() {
        return;
    }
    let place = Place::of(Command::Optimize, BAR);
    let remeshed = place.remesh();
    let volume = &remeshed.volumes["rho"];
    assert!((volume.field - 80.0).abs() < 1e-9 && (volume.meshed - 80.0).abs() < 0.8, "{volume:?}");
    let [stretch, meshed] = [whole(BAR), remeshed.meshed.cost.unwrap()];
    assert!((meshed / stretch - 1.0).abs() < 1e-3, "{meshed} {stretch}");
    // the end of the void is drawn too, and far
    assert!(remeshed.field.cost.unwrap() > 1.5 * stretch && remeshed.cut.cost.unwrap() > 1.5 * stretch, "{remeshed:?}");
    assert_eq!(remeshed.element, "tri6");
    let end = &remeshed.surfaces["x+"];
    assert!((end.before - 8.0).abs() < 1e-9 && (end.after - 4.0).abs() < 0.04 && end.used, "{end:?}");
    assert!(remeshed.surfaces["y+"].after == 0.0 && !remeshed.surfaces["y+"].used);
    assert!(
        remeshed.told.iter().any(|line| line.contains("surface \"x-\": 50 % of it is left")),
        "{:?}",
        remeshed.told
    );
    // the case runs by itself, also where the results are gone
    std::fs::remove_dir_all(place.path("out")).unwrap();
    assert_eq!(cost_of(&place.path("new/case.json")), meshed);
    assert_eq!(place.json("new/remesh.json")["meshed"]["cost"], meshed);
}

#[test]
fn half_a_block_in_space() {
    if !has_gmsh() {
        return;
    }
    let solid = with(
        BAR,
        "\"size\": [20, 8], \"cells\": [10, 5], \"element\": \"quad4\"",
        "\"size\": [20, 8, 6], \"cells\": [8, 5, 3], \"element\": \"hex8\"",
    );
    let solid = with(&solid, "[\"1 kPa\", 0]", "[\"1 kPa\", 0, 0]");
    let solid = with(&solid, "\"fix\": \"y\" }", "\"fix\": \"y\" }, { \"surface\": \"z-\", \"fix\": \"z\" }");
    let solid = with(&solid, "\"direction\": [1, 0]", "\"direction\": [1, 0, 0]");
    let place = Place::of(Command::Optimize, &solid);
    let remeshed = place.remesh();
    let (volume, stretch) = (&remeshed.volumes["rho"], whole(&solid));
    assert!((volume.meshed - 480.0).abs() < 4.8, "{volume:?}");
    assert!((remeshed.meshed.cost.unwrap() / stretch - 1.0).abs() < 1e-3, "{remeshed:?} {stretch}");
    assert_eq!(remeshed.element, "tet10");
}

/// Facets that belong to one cell alone and lie between the ends of the bar.
fn facets_within(mesh: &Mesh) -> usize {
    let is_within = |facet: &&nastic_mesh::Facet| {
        let nodes = mesh.facet_nodes(**facet).1;
        nodes.iter().all(|node| {
            let x = mesh.points()[*node as usize];
            x[0] > 1e-6 && x[0] < 20.0 - 1e-6 && x[1] > 1e-6 && x[1] < 8.0 - 1e-6
        })
    };
    mesh.boundary().iter().filter(is_within).count()
}

#[test]
fn two_materials_share_the_nodes_between_them() {
    if !has_gmsh() {
        return;
    }
    let mixture =
        r#"{ "name": "w", "kind": "mixture", "with": { "law": "neo_hooke", "young": "300 kPa", "poisson": 0 } }"#;
    let case = with(BAR, r#"{ "name": "rho", "kind": "density", "least": 0.01 }"#, mixture);
    let case = with(
        &case,
        r#""of": "rho", "space": "cell", "start": "1 - Y/8""#,
        r#""of": "w", "space": "cell", "start": "0.025 * X + 0.3""#,
    );
    let case = with(&case, r#", { "kind": "greyness", "of": "rho" }"#, "");
    let place = Place::of(Command::Optimize, &case);
    let remeshed = place.remesh();
    let mesh = nastic_io::read_mesh(place.path("new/mesh.msh"), 1.0).unwrap();
    let [soft, stiff] = ["soft_rest", "soft_w"].map(|name| mesh.region_volume(name).unwrap());
    let volume = &remeshed.volumes["w"];
    assert!((soft + stiff - 160.0).abs() < 1e-9 && (stiff - volume.field).abs() < 1.6, "{soft} {stiff} {volume:?}");
    assert_eq!(facets_within(&mesh), 0);
    let pieces = mesh.pieces();
    assert!(pieces.iter().all(|piece| *piece == 0));
    // one behind the other, of nu = 0: no strain across
    let share = stiff / 160.0;
    let [all, third] = [whole(BAR), whole(&with(BAR, "100 kPa", "300 kPa"))];
    let expected = share * third + (1.0 - share) * all;
    let meshed = remeshed.meshed.cost.unwrap();
    assert!((meshed / expected - 1.0).abs() < 1e-4, "{meshed} {expected}");
    let materials = &place.json("new/case.json")["materials"];
    assert_eq!((&materials[0]["region"], &materials[1]["region"]), (&"soft_rest".into(), &"soft_w".into()));
    assert_eq!(materials[1]["young"], "300 kPa");
}

/// Fibres by cell and by node go where they were, with the values behind their filter; a uniform pull stays one number.
#[test]
fn controls_are_carried_over() {
    if !has_gmsh() {
        return;
    }
    let case = with(
        BAR,
        "\"loads\"",
        r#""actuation": [
        { "name": "along", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0] },
        { "name": "far", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0] },
        { "name": "pull", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0] } ], "loads""#,
    );
    let further = r#""controls": [ { "of": "along", "space": "cell", "start": "-3 kPa * min(1, max(0, X / (1 mm) - 9.5))", "filter": "3 mm", "upper": 0 },
        { "of": "far", "space": "node", "start": "-0.2 kPa * X / (1 mm)", "upper": 0 },
        { "of": "pull", "space": "uniform", "start": "-0.5 kPa", "upper": 0 }, "#;
    let place = Place::of(Command::Optimize, &with(&case, "\"controls\": [ ", further));
    let remeshed = place.remesh();
    assert!(remeshed.meshed.cost.is_some(), "{remeshed:?}");
    let found = place.json("new/case.json")["controls"].clone();
    assert_eq!(found.as_array().unwrap().len(), 3, "{found}");
    assert_eq!((&found[0]["start"]["array"], found[0].get("filter")), (&"along".into(), None), "{found}");
    assert_eq!(found[2]["start"]["file"], "controls.json", "{found}");
    let fields = nastic_io::read_snapshot(place.path("new/fields.vtu")).unwrap();
    let mesh = &fields.mesh;
    let by_node = fields.point_array("far").unwrap();
    for (x, value) in mesh.points().iter().zip(&by_node.values) {
        assert!((value + 0.2e-3 * x[0]).abs() < 1e-9, "{x:?} {value}");
    }
    let by_cell = fields.cell_array("along").unwrap();
    // a step from 0 to -3 kPa, by the filter over 3 mm: one half of it goes by exp(-d / R)
    for (cell, value) in by_cell.values.iter().enumerate() {
        let distance = mesh.cell_centre(cell)[0] - 10.0;
        let far = 0.5 * (-distance.abs() / 3.0).exp();
        let expected = -3e-3 * if distance > 0.0 { 1.0 - far } else { far };
        // cells of the old mesh are 2 mm long
        assert!((value - expected).abs() < 0.6e-3, "{distance} {value} {expected}");
    }
    assert!(by_cell.values.iter().any(|value| (-2.4e-3..-1.8e-3).contains(value)));
}

/// What nothing holds is dropped: a blob beside the bar; a smaller size makes more cells.
#[test]
fn islands_are_dropped() {
    if !has_gmsh() {
        return;
    }
    let blob = "max(1 - abs(Y - 1)/3, 1.2 - ((X - 10)^2 + (Y - 7)^2)/3)";
    let case = with(BAR, "\"cells\": [10, 5]", "\"cells\": [40, 20]");
    let place = Place::of(Command::Optimize, &with(&case, "\"1 - Y/8\"", &format!("\"max(0, min(1, {blob}))\"")));
    let coarse = place.remesh();
    assert!(coarse.islands.len() == 1 && coarse.islands[0] > 1.0, "{coarse:?}");
    assert!(coarse.told.iter().any(|line| line.starts_with("dropped: 1 piece")), "{:?}", coarse.told);
    let volume = &coarse.volumes["rho"];
    assert!((volume.field - coarse.islands[0] - volume.outline).abs() < 0.01 * volume.field, "{volume:?}");
    let mut request = place.request();
    request.size = Some(0.25);
    let (fine, _) =
        nastic_remesh::remesh(&Default::default(), &request, &nastic_report::console::Console::silent()).unwrap();
    assert!(fine.cells > 2 * coarse.cells, "{} {}", fine.cells, coarse.cells);
}

/// What was meshed may be a design again: its mesh has a region of the design's name already.
#[test]
fn a_mesh_that_was_made_is_cut_again() {
    if !has_gmsh() {
        return;
    }
    let place = Place::of(Command::Optimize, BAR);
    place.remesh();
    std::fs::copy(place.path("new/mesh.msh"), place.path("mesh.msh")).unwrap();
    let mesh = "\"mesh\": { \"box\": { \"size\": [20, 8], \"cells\": [10, 5], \"element\": \"quad4\" } }";
    let case = with(&with(BAR, mesh, "\"mesh\": \"mesh.msh\""), "\"1 - Y/8\"", "\"1 - Y/4\"");
    let case = with(&case, "\"start\"", "\"lower\": 0, \"start\"");
    let case = with(&case, "\"1 - Y/4\"", "\"max(0, 1 - Y/4)\"");
    std::fs::remove_dir_all(place.path("out")).unwrap();
    place.run(Command::Optimize, "again.json", &case);
    let again = place.remesh();
    let volume = &again.volumes["rho"];
    assert!((volume.meshed - volume.outline).abs() < 0.4 && (volume.field - 40.0).abs() < 1.0, "{volume:?}");
    // the ends, where it is drawn, are 4 % wider than the middle
    assert!((again.meshed.cost.unwrap() / whole(BAR) - 1.0).abs() < 0.06, "{again:?}");
}
