//! The contacts of a patch, whatever their law.
//!
//! [`Lists`] is all that the engine knows of them: a few calls a step. What is generic over the law
//! is behind it, so that the rest of the engine is compiled once and not for every law.
use std::fmt::{self, Debug, Formatter};

use loadframe_harness::checkpoint::{self, CheckpointError};
use pulp::{Arch, Simd, WithSimd};

use super::{
    Deepest, Depths, Passage, Scenery,
    facets::{FacetCandidate, FacetList, Sides},
    law::Law,
    packed::{PackedList, PackedLists},
    pairs::PairList,
    past::Past,
    planes::WallList,
    stiffness::Springs,
    touching::{Observer, Who},
};
use crate::motion::Wrenches;

/// What the contacts of a patch act on.
#[derive(Debug)]
pub(crate) struct Acting<'a> {
    /// First particle of the patch.
    pub(crate) first: usize,
    /// On its particles.
    pub(crate) wrenches: &'a mut Wrenches,
    /// On particles of later patches, by their place in the halo.
    pub(crate) halo: &'a mut Wrenches,
    /// On each wall, planes before meshes [N]; the fourth number is the power of a mesh's turning [W].
    pub(crate) on_walls: &'a mut [[f64; 4]],
    /// Of all its contacts.
    pub(crate) deepest: &'a mut Deepest,
    /// What went through walls.
    pub(crate) passed: &'a mut Vec<Passage>,
}

/// Candidates for contact of a patch's particles, and what they remember.
pub(crate) trait Lists: Debug + Send + Sync {
    /// Works through the contacts in the widest vectors of this machine.
    fn push(&mut self, scenery: Scenery<'_>, acting: Acting<'_>);

    /// Adds a pair within the patch.
    fn add_inner(&mut self, pair: [u32; 2], springs: &Springs, past: Option<&Past>);

    /// Adds a pair with a particle of a later patch, which has this place in the halo.
    fn add_outer(&mut self, pair: [u32; 2], place: u32, springs: &Springs, past: Option<&Past>);

    /// The next pair begins a block.
    fn close_blocks(&mut self);

    /// Adds a particle at a plane.
    fn add_plane(&mut self, plane: usize, particle: u32, springs: &Springs, past: Option<&Past>);

    /// Adds the facets near a particle.
    fn add_facets(&mut self, particle: u32, candidates: &[FacetCandidate]);

    /// All is listed, at this many planes.
    fn finish(&mut self, planes: usize);

    /// Shows what touched in the last step.
    fn see(&self, observer: &mut Observer<'_>);

    /// Multiplies tan φ of all contacts.
    fn rub(&mut self, factor: f64);

    /// Candidates, those at planes not counted.
    fn candidates(&self) -> usize;

    /// Memory of the lists [bytes].
    fn bytes(&self) -> usize;

    /// For a checkpoint.
    ///
    /// # Errors
    /// When they do not serialize.
    fn pack(&self) -> Result<Vec<u8>, CheckpointError>;
}

/// The lists of a patch under one law.
#[derive(Clone, Default)]
pub(super) struct PatchLists<F: Law> {
    /// Contacts within the patch.
    inner: PairList<F>,
    /// Contacts with particles of later patches.
    outer: PairList<F>,
    /// Contacts by plane.
    walls: Vec<WallList<F>>,
    /// Contacts with the facets of all meshes.
    facets: FacetList<F>,
}

/// How many there are. (What all of them remember nobody could read, and each law would be compiled to tell it.)
impl<F: Law> Debug for PatchLists<F> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        let mut lists = formatter.debug_struct("PatchLists");
        lists.field("candidates", &self.candidates());
        lists.finish_non_exhaustive()
    }
}

impl<F: Law> PatchLists<F> {
    /// Reads what [`Lists::pack`] wrote.
    ///
    /// # Errors
    /// When the bytes are those of something else.
    pub(super) fn unpack(bytes: &[u8]) -> Result<Self, CheckpointError> {
        let packed: PackedLists = postcard::from_bytes(bytes).map_err(checkpoint::form)?;
        let mut lists = Self::default();
        packed.inner.fill(&mut lists.inner.list)?;
        packed.outer.fill(&mut lists.outer.list)?;
        lists.outer.places = packed.places;
        lists
            .walls
            .resize_with(packed.walls.len(), WallList::default);
        for (wall, packed) in lists.walls.iter_mut().zip(packed.walls) {
            packed.fill(&mut wall.list)?;
        }
        packed.facets.fill(&mut lists.facets.list)?;
        lists.facets.visitors = packed.visitors;
        Ok(lists)
    }
}

impl<F: Law> Lists for PatchLists<F> {
    fn push(&mut self, scenery: Scenery<'_>, acting: Acting<'_>) {
        Arch::new().dispatch(Push {
            lists: self,
            scenery,
            acting,
        });
    }

    fn add_inner(&mut self, pair: [u32; 2], springs: &Springs, past: Option<&Past>) {
        self.inner.list.add(pair, springs, past);
    }

    fn add_outer(&mut self, pair: [u32; 2], place: u32, springs: &Springs, past: Option<&Past>) {
        let candidate = self.outer.list.add(pair, springs, past);
        self.outer.set_place(candidate, place);
    }

    fn close_blocks(&mut self) {
        self.inner.list.close_block();
        self.outer.list.close_block();
    }

    fn add_plane(&mut self, plane: usize, particle: u32, springs: &Springs, past: Option<&Past>) {
        if self.walls.len() <= plane {
            self.walls.resize_with(plane + 1, WallList::default);
        }
        self.walls[plane].list.add(particle, springs, past);
    }

    fn add_facets(&mut self, particle: u32, candidates: &[FacetCandidate]) {
        self.facets.add(particle, candidates);
    }

    fn finish(&mut self, planes: usize) {
        self.inner.finish();
        self.outer.finish();
        self.facets.finish();
        self.walls.resize_with(planes, WallList::default);
    }

    fn see(&self, observer: &mut Observer<'_>) {
        for list in [&self.inner.list, &self.outer.list] {
            list.see(observer, |pair, lane| {
                Who::Pair([pair.a[lane], pair.b[lane]])
            });
        }
        for (plane, list) in (0..).zip(&self.walls) {
            (list.list).see(observer, |particles, lane| {
                Who::Plane([particles.0[lane], plane])
            });
        }
        (self.facets.list).see(observer, |ends, lane| {
            Who::Facet([ends.particles[lane], ends.facets[lane]])
        });
    }

    fn rub(&mut self, factor: f64) {
        self.inner.list.rub(factor);
        self.outer.list.rub(factor);
        self.walls.iter_mut().for_each(|list| list.list.rub(factor));
        self.facets.list.rub(factor);
    }

    fn candidates(&self) -> usize {
        self.inner.list.state.count + self.outer.list.state.count + self.facets.list.state.count
    }

    fn bytes(&self) -> usize {
        let walls = self.walls.iter().map(|list| list.list.bytes());
        self.inner.bytes() + self.outer.bytes() + walls.sum::<usize>() + self.facets.bytes()
    }

    fn pack(&self) -> Result<Vec<u8>, CheckpointError> {
        let walls = self.walls.iter();
        let packed = PackedLists {
            inner: PackedList::of(&self.inner.list),
            outer: PackedList::of(&self.outer.list),
            places: self.outer.places.clone(),
            walls: walls.map(|wall| PackedList::of(&wall.list)).collect(),
            facets: PackedList::of(&self.facets.list),
            visitors: self.facets.visitors.clone(),
        };
        postcard::to_stdvec(&packed).map_err(checkpoint::form)
    }
}

/// The first phase of a step for one patch.
struct Push<'a, F: Law> {
    lists: &'a mut PatchLists<F>,
    scenery: Scenery<'a>,
    acting: Acting<'a>,
}

impl<F: Law> WithSimd for Push<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            lists,
            scenery,
            acting,
        } = self;
        let kinematics = scenery.kinematics;
        let Acting {
            first,
            wrenches,
            halo,
            on_walls,
            deepest,
            passed,
        } = acting;
        let mut depths = Depths::none(simd);
        let pairs = [(&mut lists.inner, None), (&mut lists.outer, Some(halo))];
        for (list, halo) in pairs {
            list.push(simd, kinematics, first, wrenches, halo, &mut depths);
        }
        let (on_planes, on_meshes) = on_walls.split_at_mut(scenery.faces.len());
        let planes = lists.walls.iter_mut().zip(scenery.faces).zip(on_planes);
        for (wall, ((list, face), on_plane)) in (0..).zip(planes) {
            *on_plane = list.push(simd, face, kinematics, first, wrenches, &mut depths);
            deepest.take_in(depths);
            list.see_passages(face, kinematics, wall, deepest, passed);
        }
        let sides = Sides {
            first,
            wrenches,
            on_meshes,
            depths: &mut depths,
            passed,
        };
        (lists.facets).push(simd, scenery, sides);
        deepest.take_in(depths);
    }
}
