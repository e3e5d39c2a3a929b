//! Clumps that wait to take the places of spheres.
use std::f64::consts::PI;

use loadframe_api::spec::granular_scene::{Body, Clump, Equal, GranularScene, Member, Replace};
use loadframe_harness::rng::{Purpose, Streams};

use crate::{
    generate::{bounding_radius, random_rotation},
    geometry::{sphere::Sphere, union::mass_properties},
    numbers::Vector,
};

/// Spheres, by number, that some stage replaces, and the clumps about the origin that take their places,
/// in the order of the spheres. `stream` is that of the clumps' rotations; `replaced` are numbers of spheres
/// that an earlier stage has replaced.
///
/// # Errors
/// Why the clump cannot be filled.
pub(super) fn clumps(
    spec: &GranularScene,
    replace: &Replace,
    stream: usize,
    bodies: &[Body],
    replaced: &[u32],
) -> Result<(Vec<u32>, Vec<Body>), String> {
    let template = replace
        .clump
        .resolved()
        .map_err(|error| error.to_string())?;
    let (members, volume) = about_centre(&template, true);
    let own_radius = match replace.equal {
        Equal::Size => bounding_radius(&members, &Vector::zeros()),
        Equal::Mass => (volume * 0.75 / PI).cbrt(),
    };
    let random = &mut Streams::new(spec.seed, Purpose::GrainRotations).of(stream);
    let driven = spec.driven_bodies();
    let (mut numbers, mut clumps) = (Vec::new(), Vec::new());
    let mut number = 0;
    for body in bodies {
        let own = number;
        number += body.numbers() as u32;
        let Some(sphere) = body.sphere.filter(|_| replace.replaces(body)) else {
            continue;
        };
        if driven.contains(&own) || replaced.binary_search(&own).is_ok() {
            continue;
        }
        let rotation = random_rotation(random);
        let scale = sphere.radius_m / own_radius;
        let turned = members.iter().map(|member| Member {
            offset_m: (rotation * member.centre * scale).into(),
            radius_m: member.radius * scale,
        });
        numbers.push(own);
        clumps.push(Body {
            clump: Some(Clump {
                members: turned.collect(),
                filled: None,
            }),
            ..Body::at([0.0; 3], &replace.material)
        });
    }
    Ok((numbers, clumps))
}

/// Members about their centre of mass, and their volume [m³]: of the union when they are one body,
/// else the sum.
pub(super) fn about_centre(clump: &Clump, is_rigid: bool) -> (Vec<Sphere>, f64) {
    let sphere = |member: &Member| Sphere::new(member.offset_m.into(), member.radius_m);
    let mut members: Vec<Sphere> = clump.members.iter().map(sphere).collect();
    let (centre, volume) = if is_rigid {
        let properties = mass_properties(&members);
        (properties.centroid, properties.volume)
    } else {
        let volume: f64 = members.iter().map(Sphere::volume).sum();
        let weighted = members.iter().map(|member| member.centre * member.volume());
        (weighted.sum::<Vector>() / volume, volume)
    };
    for member in &mut members {
        member.centre -= centre;
    }
    (members, volume)
}
