//! The lattice of a spec on a grid, what holds it and what loads it.
use std::cell::OnceCell;

use loadframe_api::spec::composite_bending as spec;
use loadframe_api::spec::composite_bending::{CompositeBending, Grips, Way};

use super::arms::arms_middle_mm;
use super::comparison::{Comparison, Fineness, halved};
use crate::error::CompositeError;
use crate::flexure::{Drive, Flexure, Loading};
use crate::lattice::{BondPattern, BondStiffness, Geometry, Lattice, PaperRule};
use crate::load::{Load, LoadPlace};
use crate::material::{Material, Note};
use crate::section::{
    Bounds, Division, Fibre, Layout, Ply, Refinement, Section, Substance, UNBOUNDED,
};
use crate::solve::StaticOptions;
use crate::supports::{Face, FaceSupport, Supports};

/// Cells at rollers over their radius, as long as the width of contacts is not known.
const FIRST: f64 = 0.1;
/// Density of what is only brought to rest, where none is given [kg/m³]: the rest does not depend on
/// it.
const ANY_DENSITY: f64 = 1_000.0;

/// A section ready for its test.
pub(super) struct Model<'a> {
    pub(super) spec: &'a CompositeBending,
    pub(super) fineness: Fineness,
    pub(super) section: Section,
    pub(super) lattice: Lattice,
    pub(super) supports: Supports,
    /// On every particle [N].
    pub(super) load: Vec<f64>,
    pub(super) layout: Layout,
    /// The direction in which deflections count as positive.
    pub(super) direction: [f64; 2],
    /// Names of materials with what was taken for constants that were not given.
    pub(super) notes: Vec<(String, Note)>,
    /// Known once it was asked for: it takes the lines of half of the cells.
    comparison: OnceCell<Comparison>,
}

impl<'a> Model<'a> {
    pub(super) fn new(
        spec: &'a CompositeBending,
        fineness: Fineness,
    ) -> Result<Self, CompositeError> {
        let names: Vec<&String> = spec.materials.keys().collect();
        let section = section(spec, &names)?;
        let bent = flexure(spec).filter(|_| fineness.grid.graded_cells_per_fibre.is_some());
        let Some((flexure, given)) = bent else {
            return Self::refined(spec, fineness, section, &names, &[]);
        };
        let (beneath, above) = flexure.rollers(&section);
        let lines: Vec<Refinement> = beneath
            .iter()
            .chain(&above)
            .map(|roller| Refinement {
                at_mm: [
                    roller.at_mm,
                    if roller.face == Face::Top {
                        section.height_mm
                    } else {
                        0.0
                    },
                ],
                half_width_mm: FIRST * roller.radius_mm,
                cell_mm: FIRST * roller.radius_mm,
            })
            .collect();
        let model = Self::refined(spec, fineness, section.clone(), &names, &lines)?;
        // contacts are as wide as their force makes them, which a first, coarser answer tells
        let first = flexure.bend(
            &section,
            &model.lattice,
            drive(given, 1.0),
            &StaticOptions::default(),
        )?;
        let places = flexure.refinements(&section, first.force_n, fineness.contact_cells)?;
        Self::refined(spec, fineness, section, &names, &places)
    }

    fn refined(
        spec: &'a CompositeBending,
        fineness: Fineness,
        section: Section,
        names: &[&String],
        refinements: &[Refinement],
    ) -> Result<Self, CompositeError> {
        let layout = laid_out(spec, fineness, &section, refinements, UNBOUNDED)?;
        let lattice = match &spec.lattice {
            spec::Lattice::Exact(_) => Lattice::exact(&layout),
            spec::Lattice::Paper(paper) => Lattice::paper(&section, &layout, rule(*paper))?,
        };
        let mut load = vec![0.0; lattice.displacements()];
        if let Some(given) = &spec.test.load {
            resolved_load(given).add_to(&lattice, &mut load)?;
        }
        let supports = supports(spec, &lattice)?;
        let notes = layout
            .notes()
            .iter()
            .map(|(place, note)| (names[*place].clone(), *note))
            .collect();
        Ok(Self {
            spec,
            fineness,
            section,
            supports,
            load,
            direction: direction(spec),
            notes,
            lattice,
            layout,
            comparison: OnceCell::new(),
        })
    }

    /// The bent specimen on its rollers, and what the spec says of it.
    pub(super) fn flexure(&self) -> Option<(Flexure, &'a spec::Flexure)> {
        flexure(self.spec)
    }

    /// How the errors of its grid are found.
    pub(super) fn comparison(&self) -> Comparison {
        *self.comparison.get_or_init(|| {
            let is_paper = matches!(self.spec.lattice, spec::Lattice::Paper(_));
            let half = halved(self.fineness)
                .and_then(|half| self.section.fit(division(self.spec, half.grid)).ok());
            let fit = self.layout.fit();
            Comparison::of(fit, half.unwrap_or(fit), is_paper)
        })
    }

    pub(super) fn geometry(&self) -> Geometry {
        match self.spec.accuracy.knobs().geometry {
            spec::Geometry::Linear => Geometry::Linear,
            spec::Geometry::Large => Geometry::Large,
        }
    }

    /// A line for the log.
    pub(super) fn described(&self) -> String {
        let grid = self.lattice.grid();
        format!(
            "{} by {} cells, {} particles",
            grid.columns(),
            grid.rows(),
            grid.particles()
        )
    }
}

/// The section on its grid as it is before rollers make cells at their contacts smaller, within bounds.
pub(super) fn before_rollers(
    spec: &CompositeBending,
    fineness: Fineness,
    bounds: Bounds<'_>,
) -> Result<Layout, CompositeError> {
    let names: Vec<&String> = spec.materials.keys().collect();
    laid_out(spec, fineness, &section(spec, &names)?, &[], bounds)
}

fn laid_out(
    spec: &CompositeBending,
    fineness: Fineness,
    section: &Section,
    refinements: &[Refinement],
    bounds: Bounds<'_>,
) -> Result<Layout, CompositeError> {
    let division = division(spec, fineness.grid);
    let corners = if fineness.shrinks_to_corners {
        spec.held_corners()
    } else {
        Default::default()
    };
    let is_parting = spec.ply_interface.is_some() && spec.test.breaking.is_some();
    section.layout_within(division, refinements, &corners, is_parting, bounds)
}

fn division(spec: &CompositeBending, grid: spec::Grid) -> Division {
    let cells = grid.cells.map(|count| count as usize);
    match grid.graded_cells_per_fibre {
        None if grid.equal_cells || matches!(spec.lattice, spec::Lattice::Paper(_)) => {
            Division::Uniform { cells }
        }
        None => Division::Fitted { cells },
        Some(across) => Division::Graded {
            cells,
            across: across as usize,
        },
    }
}

fn flexure(spec: &CompositeBending) -> Option<(Flexure, &spec::Flexure)> {
    let way = spec.test.way()?;
    let (_, given) = way.flexure()?;
    let flexure = Flexure {
        loading: match way {
            Way::FourPoint(_) => Loading::FourPoint,
            _ => Loading::ThreePoint,
        },
        span_mm: given.span_mm,
        loading_radius_mm: given.loading_radius_mm,
        support_radius_mm: given.support_radius_mm,
    };
    Some((flexure, given))
}

/// What moves the rollers, at a share of the whole.
pub(super) fn drive(given: &spec::Flexure, share: f64) -> Drive {
    match (given.displacement_mm, given.force_n) {
        (Some(way), _) => Drive::Advance(share * way),
        (None, force) => Drive::Force(share * force.unwrap_or(0.0)),
    }
}

fn section(spec: &CompositeBending, names: &[&String]) -> Result<Section, CompositeError> {
    // names were checked with the spec
    let place = |name: &String| {
        names
            .iter()
            .position(|known| *known == name)
            .ok_or(CompositeError::OutOfRange {
                quantity: "the place of a material in the list",
                given: f64::NAN,
                allowed: "that of a material with a known name",
            })
    };
    let substances = spec.materials.values().map(|material| {
        let elastic: Option<Material> = material.elastic();
        let elastic = elastic.ok_or(CompositeError::OutOfRange {
            quantity: "the number of sets of elastic constants of a material",
            given: 0.0,
            allowed: "1",
        })?;
        Ok(Substance {
            material: elastic,
            density_kg_per_m3: material.density_kg_per_m3.unwrap_or(ANY_DENSITY),
        })
    });
    let fibres = spec.fibres.iter().map(|fibre| {
        Ok(Fibre {
            material: place(&fibre.material)?,
            through_mm: fibre.through_mm,
            angle_deg: fibre.angle_deg,
            thickness_mm: fibre.thickness_mm,
            length_mm: fibre.length_mm,
        })
    });
    let plies = spec.plies.iter().map(|ply| {
        Ok(Ply {
            material: place(&ply.material)?,
            thickness_mm: ply.thickness_mm,
            angle_deg: ply.angle_deg,
            in_plane_angle_deg: ply.in_plane_angle_deg,
        })
    });
    Ok(Section {
        length_mm: spec.section.length_mm,
        height_mm: spec.section.height_mm,
        thickness_mm: spec.section.thickness_mm,
        state: spec.section.state.into(),
        materials: substances.collect::<Result<_, CompositeError>>()?,
        matrix: spec.matrix.as_ref().map_or(Ok(0), place)?,
        matrix_angle_deg: spec.matrix_angle_deg,
        plies: plies.collect::<Result<_, CompositeError>>()?,
        fibres: fibres.collect::<Result<_, CompositeError>>()?,
    })
}

fn rule(paper: spec::Paper) -> PaperRule {
    PaperRule {
        stiffness: match paper.stiffness {
            spec::BondStiffness::PWave => BondStiffness::PWave,
            spec::BondStiffness::Bare => BondStiffness::Bare,
        },
        pattern: match paper.bonds {
            spec::BondPattern::Cross => BondPattern::Cross,
            spec::BondPattern::OneDiagonal => BondPattern::OneDiagonal,
            spec::BondPattern::Edges => BondPattern::Edges,
        },
    }
}

pub(super) fn face(face: spec::Face) -> Face {
    match face {
        spec::Face::Left => Face::Left,
        spec::Face::Right => Face::Right,
        spec::Face::Bottom => Face::Bottom,
        spec::Face::Top => Face::Top,
    }
}

fn resolved_load(load: &spec::Load) -> Load {
    Load {
        force_n: load.force_n,
        on: match &load.on {
            spec::LoadPlace::Face(given) => LoadPlace::Face(face(*given)),
            spec::LoadPlace::Patch(patch) => LoadPlace::Patch {
                face: face(patch.face),
                from_mm: patch.from_mm,
                to_mm: patch.to_mm,
            },
            spec::LoadPlace::PointMm(point) => LoadPlace::Point(*point),
            spec::LoadPlace::Body => LoadPlace::Body,
        },
    }
}

fn held(support: &spec::Support) -> FaceSupport {
    match support {
        spec::Support::Word(spec::SupportWord::Clamped) => FaceSupport::Clamped,
        spec::Support::Word(spec::SupportWord::Free) => FaceSupport::Free,
        spec::Support::Word(spec::SupportWord::Rolling) => FaceSupport::Rolling,
        spec::Support::PerAxis(axes) => {
            FaceSupport::PerAxis(axes.map(|axis| (axis == spec::Axis::Clamped).then_some(0.0)))
        }
        spec::Support::Driven(driven) => FaceSupport::PerAxis(driven.displacement_mm),
    }
}

/// What is held and where to at full load. Rollers, which hold by contact, are not here.
fn supports(spec: &CompositeBending, lattice: &Lattice) -> Result<Supports, CompositeError> {
    let grid = lattice.grid();
    match spec.test.way() {
        Some(Way::Held(given)) => {
            let faces = given
                .faces()
                .map(|(place, support)| (face(place), held(support)));
            Supports::of_faces(grid, &faces)
        }
        Some(Way::Tension(tension)) => {
            let reach = tension.strain * spec.section.length_mm;
            let across = match tension.grips {
                Grips::FreeToContract => None,
                Grips::Clamped => Some(0.0),
            };
            let faces = [
                (Face::Left, FaceSupport::PerAxis([Some(0.0), across])),
                (Face::Right, FaceSupport::PerAxis([Some(reach), across])),
            ];
            let mut supports = Supports::of_faces(grid, &faces)?;
            if across.is_none() {
                // sliding grips leave it free to move along them
                supports.hold(grid, 0, 1, 0.0)?;
            }
            Ok(supports)
        }
        Some(Way::DoubleCantilever(test)) => {
            let mut supports = Supports::none(grid);
            let way = 0.5 * test.opening_mm;
            for (height, way) in arms_middle_mm(spec).into_iter().zip([-way, way]) {
                let line = nearest(grid.y_mm(), height);
                supports.hold(grid, grid.particle(0, line), 1, way)?;
            }
            let line = nearest(grid.y_mm(), 0.5 * spec.section.height_mm);
            for axis in [0, 1] {
                supports.hold(grid, grid.particle(grid.columns(), line), axis, 0.0)?;
            }
            Ok(supports)
        }
        Some(Way::Shear(shear)) => {
            let mut supports = Supports::none(grid);
            for place in Face::ALL {
                for line in 0..place.lines_mm(grid).len() {
                    let particle = place.particle(grid, line);
                    let height = grid.place_mm(particle)[1];
                    supports.hold(grid, particle, 0, shear.strain * height)?;
                    supports.hold(grid, particle, 1, 0.0)?;
                }
            }
            Ok(supports)
        }
        Some(Way::ThreePoint(_) | Way::FourPoint(_) | Way::ShortBeam(_)) | None => {
            Ok(Supports::none(grid))
        }
    }
}

/// The line of particles nearest to a place.
pub(super) fn nearest(lines: &[f64], at: f64) -> usize {
    let lines = lines.iter().enumerate();
    let nearest = lines.min_by(|a, b| (a.1 - at).abs().total_cmp(&(b.1 - at).abs()));
    nearest.map_or(0, |(line, _)| line)
}

/// Along the load; without one along what moves a face, or what moves first; else downwards.
fn direction(spec: &CompositeBending) -> [f64; 2] {
    let unit = |[x, y]: [f64; 2]| {
        let length = x.hypot(y);
        (length > 0.0).then(|| [x / length, y / length])
    };
    let load = spec.test.load.as_ref().and_then(|load| unit(load.force_n));
    let moved = || match spec.test.way() {
        Some(Way::Held(supports)) => supports.faces().iter().find_map(|(_, support)| {
            let spec::Support::Driven(driven) = support else {
                return None;
            };
            unit(driven.displacement_mm.map(|value| value.unwrap_or(0.0)))
        }),
        _ => None,
    };
    let first = || {
        let history = spec.test.history.as_ref();
        history.and_then(|history| unit(history.velocity_mm_per_s))
    };
    load.or_else(moved).or_else(first).unwrap_or([0.0, -1.0])
}
