//! The faces of bonds: what they open across, and shear along.
use nalgebra::{Matrix3, Vector3};

use super::super::input::{BeamSection, FrameBond, FrameFibre};
use super::super::places::CentreLine;
use super::ends::BondEnd;

/// Fibres whose points, across them, are closer than this share of their mean width have their face in the plane of
/// the sheet: rounded coordinates of two crossing lines say nothing about a direction.
const COINCIDENT: f64 = 0.01;

/// ε of [`across`]: fibres that cross at less than some 8° in the plane of the sheet (1 − cos φ = ε) count as parallel.
const PARALLEL: f64 = 0.01;

/// A fibre's direction is that of the chord over this share of its width to either side: within a straight part its
/// own, and at a vertex, given with few digits, the mean of both parts.
const CHORD: f64 = 1e-3;

/// Normals of all bonds, from the first fibre to the second.
///
/// They are taken from the centre lines as given, not from nodes: how finely a fibre is divided changes no face.
pub(super) fn normals(
    fibres: &[FrameFibre],
    lines: &[CentreLine],
    bonds: &[FrameBond],
    ends: &[BondEnd],
) -> Vec<Vector3<f64>> {
    let mut at_um = vec![[0.0; 2]; bonds.len()];
    for end in ends {
        at_um[end.bond as usize][end.side] = end.arc_um;
    }
    let normals = bonds.iter().zip(at_um).map(|(bond, at_um)| {
        let fibre = bond.fibres.map(|fibre| fibre as usize);
        let sections = fibre.map(|fibre| &fibres[fibre].section);
        let [from, to] = [0, 1].map(|side| lines[fibre[side]].at(at_um[side]));
        let along = [0, 1]
            .map(|side| lines[fibre[side]].along(at_um[side], CHORD * sections[side].width_um));
        normal_of(to - from, along, sections)
    });
    normals.collect()
}

/// Across the common face of two fibres with these directions, whose points of a bond are `apart` [µm]; of any length
/// but 0.
///
/// Fibres touch as ellipses: a = (aₓ, a_y, a_z) apart, their face is across the gradient of aₓ² + a_y² + k² a_z²,
/// g = (aₓ, a_y, k² a_z), with k the width of their sections over the height. Where a sheet's fibres are nearest in the
/// metric in which contacts are found ([`crate::sheet`]), g is at right angles to both. Given points are rounded, and
/// lines with longer parts pass one another elsewhere; so [`across`] takes out of g what lies along the fibres. The
/// points themselves say little: a fibre is several times as wide as high, and a lies as flat as that.
fn normal_of(
    apart: Vector3<f64>,
    along: [Vector3<f64>; 2],
    sections: [&BeamSection; 2],
) -> Vector3<f64> {
    let across = across(along);
    let width_um = 0.5 * (sections[0].width_um + sections[1].width_um);
    if (across * apart).norm() > COINCIDENT * width_um {
        let squared = slenderness_squared(apart, sections);
        return across * Vector3::new(apart.x, apart.y, squared * apart.z);
    }
    // lengths of the columns squared sum to 1 or more, so that one of them is above 1/√3
    let axes = [Vector3::z(), Vector3::y(), Vector3::x()];
    let mut axes = axes.map(|axis| across * axis).into_iter();
    axes.find(|axis| axis.norm() > 0.5)
        .unwrap_or_else(Vector3::z)
}

/// k² [-], such that sections touch where they are so far apart: from 1, round, to that of collapsed ribbons as high as
/// their wall's area over their width, which is what a sheet is made of.
fn slenderness_squared(apart: Vector3<f64>, sections: [&BeamSection; 2]) -> f64 {
    let widths = sections.map(|section| section.width_um);
    let heights = sections.map(|section| section.area_um2 / section.width_um);
    let collapsed = (widths[0] + widths[1]) / (heights[0] + heights[1]);
    let collapsed = (collapsed * collapsed).max(1.0);
    // aₓ² + a_y² + k² a_z² = ((w₁ + w₂)/2)²
    let height = apart.z * apart.z;
    let rest = 0.25 * (widths[0] + widths[1]).powi(2) - apart.xy().norm_squared();
    if rest < collapsed * height {
        (rest / height).max(1.0)
    } else {
        collapsed
    }
}

/// Takes out of a vector what lies along fibres with the unit directions t₁ and t₂.
///
/// P = (1 + T²/ε²)⁻¹, T = t₁t₁ᵀ + t₂t₂ᵀ: across both fibres T has the eigenvalue 0, and P leaves as it is what lies
/// there; of what lies in their plane, with the eigenvalues λ = 1 ± cos θ along t₁ ± t₂, it leaves 1/(1 + λ²/ε²), 10⁻⁴
/// where they cross at right angles. What lies between the axes of parallel fibres has 1 − cos θ = 0 and stays, too, and
/// nothing jumps in between. Of θ only the angle φ in the plane of the sheet is a crossing, see [`of_slopes`].
fn across(along: [Vector3<f64>; 2]) -> Matrix3<f64> {
    let [one, other] = along;
    let crossing = one * one.transpose() + other * other.transpose() - of_slopes(along);
    let scaled = crossing / PARALLEL;
    let sum = Matrix3::identity() + scaled * scaled;
    // at least the identity: it has an inverse
    sum.try_inverse().unwrap_or_else(Matrix3::identity)
}

/// The part of T along d = t₁ − t₂ that fibres have by their slopes alone: cos φ (1 − cos(β₁ − β₂)) with the angles β
/// out of the plane of the sheet.
///
/// 1 − cos θ is that and (1 − cos φ)(1 − sin β₁ sin β₂). Straight fibres that run one above the other, φ = 0, and climb
/// in opposite ways would go through one another: a sheet is pressed, and they bend and lie flat on one another. So
/// such a face is across their mean direction only, as of parallel ones; crossing at right angles takes nothing away.
fn of_slopes([one, other]: [Vector3<f64>; 2]) -> Matrix3<f64> {
    let level = one.xy().norm() * other.xy().norm();
    if level <= 0.0 {
        return Matrix3::zeros();
    }
    // turned, such that both lead the same way
    let cosine = one.xy().dot(&other.xy()) / level;
    let other = other * cosine.signum();
    let between = one - other;
    let slopes = 1.0 - level - one.z * other.z;
    // at most the whole, |d|²/2 = 1 − cos θ, but for rounding where there is hardly any
    let whole = between.norm_squared().max(f64::MIN_POSITIVE);
    let part = (slopes / whole).clamp(0.0, 0.5);
    between * between.transpose() * (cosine.abs() * part)
}

#[cfg(test)]
mod tests {
    use super::super::super::element::Element;
    use super::super::Network;
    use super::*;
    use crate::frame::tests::{bond, fibre, model, tube};
    use crate::frame::{Attachment, FrameModel, Level};
    use crate::sheet::{
        LengthDistribution, Lumen, Orientation, Placement, Pulp, SheetPlan, wall_area_um2,
    };
    use loadframe_numerics::Team;

    /// P leaves 10⁻⁴ of what lies along fibres that cross at right angles.
    const LEFT: f64 = 2e-4;

    fn towards(degrees: f64) -> Vector3<f64> {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Vector3::new(cos, sin, 0.0)
    }

    /// Of fibres of 30 µm, 30 µm high if round and 8.5 µm if collapsed.
    fn normal(apart: [f64; 3], along: [Vector3<f64>; 2]) -> Vector3<f64> {
        normal_of(apart.into(), along, [&tube(), &tube()]).normalize()
    }

    fn is_along(found: Vector3<f64>, expected: Vector3<f64>, error: f64) {
        let apart = (found - expected.normalize()).norm();
        assert!(apart <= error, "{found} instead of {expected}");
    }

    #[test]
    fn the_face_of_fibres_that_cross_is_across_both() {
        // one climbs, the other is level: the points are apart along both much more than across
        let slope = Vector3::<f64>::new(1.0, 0.0, 0.2).normalize();
        let across = slope.cross(&Vector3::y());
        let apart = [6.0, -8.0, 3.0];
        let expected = across * f64::signum(across.z);
        is_along(normal(apart, [slope, Vector3::y()]), expected, 0.01);
        // the upper fibre is given first
        let below = apart.map(|part| -part);
        is_along(normal(below, [slope, Vector3::y()]), -expected, 0.01);
        // to 30°, where less is taken out
        for degrees in [30.0, 60.0, 120.0, 150.0] {
            let along = [Vector3::x(), towards(degrees)];
            is_along(normal([0.0, 0.0, 8.0], along), Vector3::z(), 1e-12);
            is_along(normal([2.0, 3.0, 8.0], along), Vector3::z(), 0.01);
        }
    }

    #[test]
    fn parallel_fibres_have_the_face_of_touching_sections() {
        let along = [Vector3::x(), -Vector3::x()];
        is_along(normal([0.0, 25.0, 0.0], along), Vector3::y(), 1e-12);
        is_along(normal([4.0, 25.0, 0.0], along), Vector3::y(), LEFT);
        is_along(normal([0.0, 0.0, -8.0], along), -Vector3::z(), 1e-12);
        // round ones of 30 µm touch across the line between their axes
        let round = [0.0, 18.0, 24.0];
        is_along(normal(round, along), round.into(), 1e-12);
        // ribbons, ellipses of 30 µm by A/30 µm: gradient (y/w², z/h²)
        let height = tube().area_um2 / 30.0;
        let ribbon = [0.0, 18.0, 0.8 * height];
        let expected = Vector3::new(0.0, 18.0 / 900.0, 0.8 / height);
        is_along(normal(ribbon, along), expected, 1e-12);
        assert!(expected.normalize().z > 0.97);
        // nothing jumps from those to fibres that cross
        let turned = [towards(0.0), towards(1.0)];
        is_along(normal(ribbon, turned), expected, 0.01);
    }

    /// Unit direction turned in the plane, and out of it by a slope.
    fn climbing(degrees: f64, slope: f64) -> Vector3<f64> {
        (towards(degrees) + slope * Vector3::z()).normalize()
    }

    #[test]
    fn fibres_one_above_the_other_lie_flat_whatever_their_slopes() {
        // of straight ones the common perpendicular is ŷ
        for (one, other) in [(0.3, -0.3), (-1.0, 1.0), (0.0, 0.6)] {
            let mean = climbing(0.0, one) + climbing(0.0, other);
            let expected = mean.normalize().cross(&Vector3::y());
            for turn in [1.0, -1.0] {
                let along = [climbing(0.0, one), turn * climbing(0.0, other)];
                is_along(normal([0.0, 0.0, 8.0], along), expected, LEFT);
                is_along(normal([0.0, 25.0, 0.0], along), Vector3::y(), 1e-12);
                // rounded points, too
                is_along(normal([0.0; 3], along), expected, LEFT);
            }
        }
        // of d as of n, less what is left of it: d̂ ∝ (0, −sin φ/2, s), λ = (1 − cos φ)(1 + sin²β)
        let (slope, angle) = (0.3_f64, 2.0_f64.to_radians());
        let along = [climbing(-1.0, slope), climbing(1.0, -slope)];
        let sine = (0.5 * angle).sin();
        let squared = slope * slope / (1.0 + slope * slope);
        let turn = (1.0 - angle.cos()) * (1.0 + squared) / 0.01;
        let left = 1.0 / (1.0 + turn * turn);
        let length = sine.hypot(slope);
        let d = Vector3::new(0.0, -sine, slope) / length;
        let n = Vector3::new(0.0, slope, sine) / length;
        let expected = n * n.z + d * (left * d.z);
        assert!(expected.normalize().z > 0.9999, "{expected}");
        is_along(normal([0.0, 0.0, 8.0], along), expected, 1e-9);
    }

    #[test]
    fn faces_turn_steadily_as_slopes_become_crossings() {
        let at = |degrees: f64| {
            normal(
                [2.0, -1.0, 8.0],
                [climbing(0.0, 0.3), climbing(degrees, -0.3)],
            )
        };
        let tenths = (0..1800).map(|tenth| 0.1 * f64::from(tenth));
        for degrees in tenths {
            let turn = (at(degrees + 0.1) - at(degrees)).norm();
            // fastest near 10°, about 8° for each degree
            assert!(turn < 0.02, "{turn} at {degrees}");
        }
        // straight ones that cross are as they were: across both
        let [one, other] = [climbing(0.0, 0.3), climbing(90.0, -0.3)];
        let across = one.cross(&other);
        is_along(normal([0.0, 0.0, 8.0], [one, other]), across, 0.01);
    }

    #[test]
    fn rounded_points_say_nothing() {
        let laps = [Vector3::x(), Vector3::x()];
        for apart in [
            [0.0; 3],
            [0.5, 0.0, 0.0],
            [-30.0, 0.0, 0.0],
            [0.0, 0.05, -0.1],
        ] {
            is_along(normal(apart, laps), Vector3::z(), 1e-12);
        }
        let crossing = [towards(10.0), towards(75.0)];
        is_along(normal([5.0, -4.0, 0.0], crossing), Vector3::z(), 1e-12);
        // upright fibres have no face that is across the sheet
        let upright = [Vector3::z(), Vector3::z()];
        is_along(normal([0.0, 0.0, 0.5], upright), Vector3::y(), 1e-12);
        let wall = [Vector3::z(), Vector3::y()];
        is_along(normal([0.0; 3], wall), Vector3::x(), 1e-12);
    }

    #[test]
    fn a_line_has_the_mean_direction_at_its_points() {
        let line = fibre(&[
            [0.0; 3],
            [40.0, 0.0, 0.0],
            [40.0, 30.0, 0.0],
            [40.0, 0.0, 0.0],
        ]);
        let line = CentreLine::new(0, &line).unwrap();
        for (arc, expected) in [(0.0, 0.0), (39.0, 0.0), (40.0, 45.0), (41.0, 90.0)] {
            is_along(line.along(arc, 0.03), towards(expected), 1e-10);
        }
        assert_eq!(line.along(70.0, 0.03), Vector3::zeros());
    }

    fn normals_of(network: &Network) -> Vec<Vector3<f64>> {
        let bonds = &network.elements()[network.segments()..];
        let normal = |bond: &Element| bond.axes.row(0).transpose();
        bonds.iter().map(normal).collect()
    }

    #[test]
    fn faces_do_not_depend_on_how_fibres_are_divided() {
        let fibres = [
            fibre(&[[0.0; 3], [90.0, 0.0, 0.0], [90.0, 80.0, 20.0]]),
            fibre(&[[20.0, -50.0, 5.0], [30.0, 60.0, 9.0]]),
            fibre(&[[80.0, 50.0, 16.0], [130.0, 60.0, 16.0]]),
        ];
        let bonds = [bond([0, 1], [24.0, 50.0]), bond([2, 0], [10.0, 147.0])];
        let expected = {
            let whole = Network::new(&fibres, &bonds, model(Level::Beam, 200.0)).unwrap();
            normals_of(&whole)
        };
        // from 2 down to 0
        assert!(expected[0].z > 0.9 && expected[1].z < -0.9, "{expected:?}");
        for attachment in [Attachment::Node, Attachment::Inside] {
            for segment_um in [5.0, 17.0, 1000.0] {
                let divided = FrameModel {
                    attachment,
                    segment_um: Some(segment_um),
                    ..model(Level::Beam, 200.0)
                };
                let network = Network::new(&fibres, &bonds, divided).unwrap();
                assert_eq!(normals_of(&network), expected);
            }
        }
    }

    #[test]
    fn in_a_sheet_faces_are_across_both_fibres_from_the_one_to_the_other() {
        let (width_um, wall_um) = (28.0, 2.0);
        let plan = SheetPlan {
            size_um: [600.0, 400.0],
            grammage_ug_per_um2: 20e-6,
            pulps: vec![Pulp {
                mass_fraction: 1.0,
                length: LengthDistribution::Fixed { length_um: 500.0 },
                width_um,
                wall_um,
                coarseness_ug_per_um: 2.45e-4,
                shape_factor: 0.97,
                lumen: Lumen::Collapsed,
            }],
            orientation: Orientation::Uniform,
            placement: Placement::Deposition { flexibility: 0.3 },
            segment_um: None,
            gap_um: None,
        };
        let laid = plan.lay(1, &Team::alone()).unwrap();
        let section = BeamSection {
            width_um,
            area_um2: wall_area_um2(width_um, wall_um),
            ..tube()
        };
        for sheet in [
            &laid,
            &laid.coarsened(28.0).unwrap(),
            &laid.coarsened(112.0).unwrap(),
        ] {
            let fibres = sheet.fibres.iter().map(|fibre| FrameFibre {
                centre_line_um: fibre.centre_line_um.clone(),
                section,
            });
            let fibres: Vec<FrameFibre> = fibres.collect();
            let bonds = sheet.contacts.iter().map(|contact| FrameBond {
                area_um2: contact.area_um2,
                ..bond(contact.fibres, contact.at_um)
            });
            let bonds: Vec<FrameBond> = bonds.collect();
            assert!(bonds.len() > 100, "{}", bonds.len());
            let network = Network::new(&fibres, &bonds, model(Level::Beam, 600.0)).unwrap();
            let lines = fibres.iter().enumerate();
            let lines: Vec<CentreLine> = lines
                .map(|(number, fibre)| CentreLine::new(number, fibre).unwrap())
                .collect();
            let mut crossing = 0;
            for (normal, bond) in normals_of(&network).into_iter().zip(&bonds) {
                let line = |side: usize| &lines[bond.fibres[side] as usize];
                let along = [0, 1].map(|side| line(side).along(bond.at_um[side], CHORD * width_um));
                let apart = line(1).at(bond.at_um[1]) - line(0).at(bond.at_um[0]);
                if along[0].cross(&along[1]).z.abs() < 0.5 || apart.z.abs() < 1.0 {
                    continue;
                }
                crossing += 1;
                // of what is in the plane, a few times what is across, 1 − cos 30° leaves ε²/0.134²
                let tilts = along.map(|along| normal.dot(&along).abs());
                assert!(tilts.iter().all(|&tilt| tilt < 0.03), "{tilts:?}");
                assert!(normal.z * apart.z > 0.0, "{normal} {apart}");
                // of slopes up to 0.3 that fall towards one another at 30°: 1/√(1 + (0.3/sin 15°)²)
                assert!(normal.z.abs() > 0.6, "{normal}");
            }
            assert!(2 * crossing > bonds.len(), "{crossing}");
        }
    }
}
