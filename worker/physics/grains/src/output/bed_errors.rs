//! How wrong results of beds may be, as measured before.
//!
//! Tables are what `tests/stated_errors measure KIND SPECS` writes; [`ErrorTable`] reads them. Two sources are
//! told apart. `specimens` is what the same test on another bed finds: the root mean square difference of
//! two beds of one spec at one preset, of ballast `reference`, of soil `draft`, or half of what 95 % stayed below where that is more. `preset`
//! is what a preset is off beyond that, step, softened preparation and rate together; where it was not more
//! than beds differ by, it is no part. What `reference` itself leaves is not in it;
//! where no `reference` was held against another, it has the level of `standard`.
use loadframe_api::spec::granular_scene::{Grain, Sizes};
use loadframe_api::{Preset, Quantity, Report};
use loadframe_harness::{ErrorTable, Likeness};

/// Presets, the coarsest first; a table has them as levels 2, 1 and 0.
const PRESETS: [Preset; 3] = [Preset::Draft, Preset::Standard, Preset::Reference];

/// A result, and the one whose size its error was measured over: mostly itself.
pub(crate) type Sized = (&'static str, &'static str);

/// A test as it is compared with a table.
pub(crate) struct Bed<'a> {
    pub(crate) traits: &'a [(&'static str, f64)],
    /// The level of its knobs, see [`level`].
    pub(crate) level: Option<f64>,
    pub(crate) results: &'a [Sized],
}

/// Gives results the errors that are known of them. Returns what is to be said of those that have none.
pub(crate) fn add(report: &mut Report, table: &str, bed: &Bed<'_>) -> Option<String> {
    let table = match ErrorTable::read(table) {
        Ok(table) => table,
        Err(error) => return Some(format!("results have no error: its table is none: {error}")),
    };
    let Some(level) = bed.level else {
        return Some(
            "results have no error: a knob of accuracy is coarser than in draft, the coarsest that was \
             measured"
                .to_owned(),
        );
    };
    let mut sized = Report::default();
    for (name, size) in bed.results {
        let value = |name: &str| report.summary.get(name)?.value;
        if let (Some(_), Some(size)) = (value(name), value(size)) {
            let quantity = Quantity::new(size, "", "");
            sized.summary.insert((*name).to_owned(), quantity);
        }
    }
    let results: Vec<_> = bed.results.iter().map(|(name, _)| (*name, *name)).collect();
    let job = Likeness {
        traits: bed.traits,
        knobs: &[("specimens", 1.0), ("preset", level)],
        results: &results,
    };
    let words = table.add(&mut sized, &job);
    for (name, quantity) in sized.summary {
        if let (Some(known), Some(error)) = (report.summary.get_mut(&name), quantity.error) {
            *known = known.clone().with_error(error.parts);
        }
    }
    report.warnings.extend(sized.warnings);
    words
}

/// The level of the finest preset that no knob is coarser than; `None` where even `draft` is finer. Knobs are
/// given as numbers that are coarser the larger they are.
pub(crate) fn level<const N: usize>(
    own: [f64; N],
    of_preset: impl Fn(Preset) -> [f64; N],
) -> Option<f64> {
    let is_as_coarse = |preset: &Preset| {
        let of_preset = of_preset(*preset);
        own.iter()
            .zip(of_preset)
            .all(|(own, coarse)| *own <= coarse)
    };
    let place = PRESETS.iter().rposition(is_as_coarse)?;
    Some((PRESETS.len() - 1 - place) as f64)
}

/// Diameter of the ball of a mean grain's volume [m], and the largest over the smallest, of spheres whose
/// radii are even between two numbers: no others were measured.
pub(crate) fn spheres(shape: &Grain, sizes: Option<&Sizes>) -> Option<[f64; 2]> {
    let (Grain::Sphere, Some(sizes @ Sizes::Uniform { .. })) = (shape, sizes) else {
        return None;
    };
    let [smallest, largest] = sizes.range();
    let diameter = (sizes.mean_volume() * 6.0 / std::f64::consts::PI).cbrt();
    Some([diameter, largest / smallest])
}
