//! What a run does, stage by stage.
//!
//! [`run`](self::run) goes through the stages of a spec with a [`runner`], which is the engine, its journal and
//! what a stage still needs. [`plan`] tells when a stage is done. What stages do has a file each:
//! [`drives`] of walls and bodies, [`supply`], [`removal`] and [`replacing`] of bodies, [`placing`],
//! [`stiffening`].
//! [`stepping`] does the steps, [`looks`] reads and judges the scene when one is looked at, [`limits`]
//! says how large a step may be, and a [`checkpoint`] is the whole run. Below:
//! [`output`](crate::output), [`observe`](crate::observe), [`step`](crate::step).
mod checkpoint;
mod drives;
mod limits;
mod looks;
mod placing;
mod plan;
mod removal;
mod replacing;
pub(crate) mod run;
mod runner;
mod stepping;
mod stiffening;
mod supply;
