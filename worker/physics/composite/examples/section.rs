//! Solves a section given as JSON and prints what is measured on it as JSON.
//!
//! `section CASE.json [COLUMNS ROWS [uniform | graded] [static | cg | large]]`: the file has the
//! fields of a `composite_bending` spec that this crate knows; the grid may be given instead of the
//! file's.
#![allow(clippy::print_stdout, reason = "a command for the shell")]

use std::collections::BTreeMap;
use std::error::Error;
use std::time::Instant;

use loadframe_composite::lattice::{BondPattern, BondStiffness, Geometry, Lattice, PaperRule};
use loadframe_composite::load::{Load, LoadPlace};
use loadframe_composite::material::{Material, Orthotropic, PlaneState};
use loadframe_composite::measure::{face_mean_mm, point_mm};
use loadframe_composite::section::{Division, Fibre, Section, Substance};
use loadframe_composite::solve::{Method, StaticOptions, equilibrium};
use loadframe_composite::supports::{Face, FaceSupport, Supports};
use serde::Deserialize;

#[derive(Deserialize)]
struct Case {
    section: SectionFields,
    materials: BTreeMap<String, MaterialFields>,
    matrix: String,
    #[serde(default)]
    matrix_angle_deg: f64,
    #[serde(default)]
    fibres: Vec<FibreFields>,
    grid: GridFields,
    #[serde(default)]
    lattice: LatticeFields,
    test: TestFields,
    #[serde(default)]
    probes_mm: Vec<[f64; 2]>,
}

#[derive(Deserialize)]
struct SectionFields {
    length_mm: f64,
    height_mm: f64,
    thickness_mm: f64,
    state: String,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum MaterialFields {
    Isotropic {
        youngs_modulus_mpa: f64,
        poisson_ratio: f64,
    },
    Orthotropic {
        modulus_1_mpa: f64,
        modulus_2_mpa: f64,
        poisson_ratio_12: f64,
        shear_modulus_12_mpa: Option<f64>,
    },
}

#[derive(Deserialize)]
struct FibreFields {
    material: String,
    through_mm: [f64; 2],
    angle_deg: f64,
    thickness_mm: f64,
    length_mm: Option<f64>,
}

#[derive(Deserialize)]
struct GridFields {
    cells: [usize; 2],
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum LatticeFields {
    Exact {},
    Paper { stiffness: String, bonds: String },
}

impl Default for LatticeFields {
    fn default() -> Self {
        Self::Exact {}
    }
}

#[derive(Deserialize)]
struct TestFields {
    supports: BTreeMap<String, String>,
    load: LoadFields,
}

#[derive(Deserialize)]
struct LoadFields {
    force_n: [f64; 2],
    on: OnFields,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum OnFields {
    Face(String),
    Patch {
        face: String,
        from_mm: f64,
        to_mm: f64,
    },
    PointMm([f64; 2]),
    Body,
}

fn face(name: &str) -> Result<Face, String> {
    match name {
        "left" => Ok(Face::Left),
        "right" => Ok(Face::Right),
        "bottom" => Ok(Face::Bottom),
        "top" => Ok(Face::Top),
        other => Err(format!("no face is called {other:?}")),
    }
}

fn section(case: &Case) -> Result<Section, Box<dyn Error>> {
    let names: Vec<&String> = case.materials.keys().collect();
    let place = |name: &String| {
        names
            .iter()
            .position(|known| *known == name)
            .ok_or_else(|| format!("no material is called {name:?}"))
    };
    let materials = case
        .materials
        .values()
        .map(|fields| Substance {
            material: match *fields {
                MaterialFields::Isotropic {
                    youngs_modulus_mpa,
                    poisson_ratio,
                } => Material::Isotropic {
                    youngs_modulus_mpa,
                    poisson_ratio,
                },
                MaterialFields::Orthotropic {
                    modulus_1_mpa,
                    modulus_2_mpa,
                    poisson_ratio_12,
                    shear_modulus_12_mpa,
                } => Material::Orthotropic(Orthotropic {
                    modulus_1_mpa,
                    modulus_2_mpa,
                    poisson_ratio_12,
                    shear_modulus_12_mpa,
                    modulus_3_mpa: None,
                    poisson_ratio_13: None,
                    poisson_ratio_23: None,
                    shear_modulus_13_mpa: None,
                    shear_modulus_23_mpa: None,
                }),
            },
            density_kg_per_m3: 1_000.0,
        })
        .collect();
    Ok(Section {
        length_mm: case.section.length_mm,
        height_mm: case.section.height_mm,
        thickness_mm: case.section.thickness_mm,
        state: match case.section.state.as_str() {
            "plane_stress" => PlaneState::Stress,
            "plane_strain" => PlaneState::Strain,
            other => return Err(format!("no state is called {other:?}").into()),
        },
        materials,
        matrix: place(&case.matrix)?,
        matrix_angle_deg: case.matrix_angle_deg,
        plies: Vec::new(),
        fibres: case
            .fibres
            .iter()
            .map(|fibre| {
                Ok(Fibre {
                    material: place(&fibre.material)?,
                    through_mm: fibre.through_mm,
                    angle_deg: fibre.angle_deg,
                    thickness_mm: fibre.thickness_mm,
                    length_mm: fibre.length_mm,
                })
            })
            .collect::<Result<_, String>>()?,
    })
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let path = arguments
        .first()
        .ok_or("usage: section CASE.json [COLUMNS ROWS ...]")?;
    let case: Case = serde_json::from_slice(&std::fs::read(path)?)?;
    let cells = match arguments.get(1..3) {
        Some([columns, rows]) => [columns.parse()?, rows.parse()?],
        _ => case.grid.cells,
    };
    let said = |word: &str| arguments.iter().skip(3).any(|argument| argument == word);
    let division = if said("graded") {
        Division::Graded { cells, across: 2 }
    } else {
        Division::Uniform { cells }
    };
    let started = Instant::now();
    let section = section(&case)?;
    let layout = section.layout(division)?;
    let lattice = match &case.lattice {
        LatticeFields::Exact {} => Lattice::exact(&layout),
        LatticeFields::Paper { stiffness, bonds } => {
            let rule = PaperRule {
                stiffness: match stiffness.as_str() {
                    "bare" => BondStiffness::Bare,
                    _ => BondStiffness::PWave,
                },
                pattern: match bonds.as_str() {
                    "edges" => BondPattern::Edges,
                    "one_diagonal" => BondPattern::OneDiagonal,
                    _ => BondPattern::Cross,
                },
            };
            Lattice::paper(&section, &layout, rule)?
        }
    };
    let grid = lattice.grid();
    let mut faces = Vec::new();
    for (name, support) in &case.test.supports {
        let support = match support.as_str() {
            "clamped" => FaceSupport::Clamped,
            "rolling" => FaceSupport::Rolling,
            "free" => FaceSupport::Free,
            other => return Err(format!("no support is called {other:?}").into()),
        };
        faces.push((face(name)?, support));
    }
    let supports = Supports::of_faces(grid, &faces)?;
    let load = Load {
        force_n: case.test.load.force_n,
        on: match &case.test.load.on {
            OnFields::Face(name) => LoadPlace::Face(face(name)?),
            OnFields::Patch {
                face: name,
                from_mm,
                to_mm,
            } => LoadPlace::Patch {
                face: face(name)?,
                from_mm: *from_mm,
                to_mm: *to_mm,
            },
            OnFields::PointMm(point) => LoadPlace::Point(*point),
            OnFields::Body => LoadPlace::Body,
        },
    };
    let mut forces = vec![0.0; lattice.displacements()];
    load.add_to(&lattice, &mut forces)?;
    let options = StaticOptions {
        geometry: if said("large") {
            Geometry::Large
        } else {
            Geometry::Linear
        },
        method: if said("cg") {
            Method::ConjugateGradients
        } else {
            Method::Automatic
        },
        ..StaticOptions::default()
    };
    let made = started.elapsed().as_secs_f64();
    let rest = equilibrium(&lattice, &supports, &forces, &options)?;
    let seconds = started.elapsed().as_secs_f64();
    let u = &rest.displacements_mm;
    let points = case
        .probes_mm
        .iter()
        .map(|&point| point_mm(grid, point, u))
        .collect::<Result<Vec<_>, _>>()?;
    let answer = serde_json::json!({
        "cells": [grid.columns(), grid.rows()],
        "mean_top_mm": face_mean_mm(grid, Face::Top, u),
        "mean_bottom_mm": face_mean_mm(grid, Face::Bottom, u),
        "points_mm": points,
        "energy_n_mm": rest.energy_n_mm,
        "residual": rest.residual,
        "reaction_error": rest.reaction_error,
        "solutions": rest.solutions,
        "iterations": rest.iterations,
        "inverted_cells": lattice.inverted_cells(u),
        "seconds_making": made,
        "seconds": seconds,
    });
    println!("{answer}");
    Ok(())
}
