//! Kernels in the widest vector instructions that the machine has.
//!
//! No machine changes a result: products and sums are fused where the code says so and nowhere
//! else, and sums have a fixed order.
use pulp::{Arch, Simd, WithSimd};

/// Runs `kernel`, compiled for every kind of machine, as compiled for this one. It must be a
/// closure marked `#[inline(always)]`, and so must be all that it calls.
#[inline(always)]
pub fn wide<R>(kernel: impl FnMut() -> R) -> R {
    struct Kernel<F>(F);
    impl<R, F: FnMut() -> R> WithSimd for Kernel<F> {
        type Output = R;

        // called as `FnMut`: the call of a closure as `FnOnce` goes through a function that is
        // compiled for the plainest machine
        #[inline(always)]
        fn with_simd<S: Simd>(mut self, _: S) -> R {
            (self.0)()
        }
    }
    Arch::new().dispatch(Kernel(kernel))
}
