//! Thinning a curve for display.
//!
//! Points are gathered in buckets of equal length, of which each keeps the points with the
//! smallest and the largest value of the second column, the one people look at. The number of
//! points need not be known: once the buckets are too many, neighbours are joined and the buckets
//! to come are twice as long, so that memory stays that of the answer.

/// A thinning under way, of points that are lists of numbers.
#[derive(Debug)]
pub(super) struct Decimation<P> {
    most: usize,
    /// Points that every bucket but the last holds.
    length: usize,
    buckets: Vec<Bucket<P>>,
    /// For every column, the points of its smallest and largest value.
    extremes: Vec<(Indexed<P>, Indexed<P>)>,
    first: Option<Indexed<P>>,
    last: Option<Indexed<P>>,
    count: usize,
}

/// A point and its place in the curve.
type Indexed<P> = (usize, P);

#[derive(Debug)]
struct Bucket<P> {
    low: Indexed<P>,
    high: Indexed<P>,
    filled: usize,
}

impl<P: AsRef<[f64]> + Clone> Bucket<P> {
    fn take(&mut self, low: &Indexed<P>, high: &Indexed<P>, filled: usize) {
        if height(low.1.as_ref()) < height(self.low.1.as_ref()) {
            self.low.clone_from(low);
        }
        if height(high.1.as_ref()) > height(self.high.1.as_ref()) {
            self.high.clone_from(high);
        }
        self.filled += filled;
    }
}

fn height(point: &[f64]) -> f64 {
    point.get(1).copied().unwrap_or(0.0)
}

impl<P: AsRef<[f64]> + Clone> Decimation<P> {
    /// Thins out to at most `most` points (at least 4).
    pub(super) fn new(most: usize) -> Self {
        Self {
            most: most.max(4),
            length: 1,
            buckets: Vec::new(),
            extremes: Vec::new(),
            first: None,
            last: None,
            count: 0,
        }
    }

    /// Takes the next point.
    pub(super) fn add(&mut self, point: P) {
        let point = (self.count, point);
        self.count += 1;
        if self.first.is_none() {
            self.first = Some(point.clone());
            let both = || (point.clone(), point.clone());
            self.extremes = point.1.as_ref().iter().map(|_| both()).collect();
        }
        for (column, (low, high)) in self.extremes.iter_mut().enumerate() {
            let value = |point: &Indexed<P>| point.1.as_ref().get(column).copied().unwrap_or(0.0);
            if value(&point) < value(low) {
                low.clone_from(&point);
            }
            if value(&point) > value(high) {
                high.clone_from(&point);
            }
        }
        match self.buckets.last_mut() {
            Some(bucket) if bucket.filled < self.length => bucket.take(&point, &point, 1),
            _ => {
                // every bucket gives up to two points
                if self.buckets.len() >= self.most {
                    join(&mut self.buckets);
                    self.length *= 2;
                }
                self.buckets.push(Bucket {
                    low: point.clone(),
                    high: point.clone(),
                    filled: 1,
                });
            }
        }
        self.last = Some(point);
    }

    /// The points kept, in order.
    pub(super) fn finish(mut self) -> Vec<P> {
        // the ends and the extremes, the second column's before the others', may take half the room
        let mut kept: Vec<Indexed<P>> = Vec::new();
        let room = (self.most / 2).max(2);
        let looked_at = 1.min(self.extremes.len());
        self.extremes.rotate_left(looked_at);
        let extremes = self
            .extremes
            .into_iter()
            .flat_map(|(low, high)| [low, high]);
        for point in self.first.into_iter().chain(self.last).chain(extremes) {
            if kept.len() < room && kept.iter().all(|(index, _)| *index != point.0) {
                kept.push(point);
            }
        }
        let mut buckets = self.buckets;
        while self.count > self.most && kept.len() + 2 * buckets.len() > self.most {
            join(&mut buckets);
        }
        kept.extend(
            buckets
                .into_iter()
                .flat_map(|bucket| [bucket.low, bucket.high]),
        );
        sort(&mut kept);
        kept.into_iter().map(|(_, point)| point).collect()
    }
}

/// Joins neighbouring buckets.
fn join<P: AsRef<[f64]> + Clone>(buckets: &mut Vec<Bucket<P>>) {
    let mut joined: Vec<Bucket<P>> = Vec::with_capacity(buckets.len() / 2 + 1);
    for (index, bucket) in buckets.drain(..).enumerate() {
        match joined.last_mut() {
            Some(neighbour) if index % 2 == 1 => {
                neighbour.take(&bucket.low, &bucket.high, bucket.filled);
            }
            _ => joined.push(bucket),
        }
    }
    *buckets = joined;
}

fn sort<P>(points: &mut Vec<Indexed<P>>) {
    points.sort_by_key(|(index, _)| *index);
    points.dedup_by_key(|(index, _)| *index);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thinned(count: usize, most: usize, height: impl Fn(usize) -> f64) -> Vec<Vec<f64>> {
        let mut decimation = Decimation::new(most);
        for index in 0..count {
            decimation.add(vec![
                index as f64,
                height(index),
                -height(index) * index as f64,
            ]);
        }
        decimation.finish()
    }

    #[test]
    fn few_points_are_all_kept() {
        for count in [0, 1, 9, 10] {
            let points = thinned(count, 10, |index| index as f64);
            let places: Vec<f64> = points.iter().map(|point| point[0]).collect();
            let all: Vec<f64> = (0..count).map(|index| index as f64).collect();
            assert_eq!(places, all);
        }
    }

    #[test]
    fn ends_and_extremes_stay_whatever_the_length() {
        let saw = |index: usize| match index {
            777 => 1e6,
            1234 => -1e6,
            _ => (index % 17) as f64,
        };
        for count in [2000, 4096, 10_001] {
            for most in [10, 16, 100, 1999] {
                let points = thinned(count, most, saw);
                assert!(points.len() <= most, "{} points of {most}", points.len());
                assert!(
                    points.len() * 5 >= most,
                    "{} points of {most}",
                    points.len()
                );
                let has = |place: usize| points.iter().any(|point| point[0] as usize == place);
                assert!(
                    has(0) && has(777) && has(1234) && has(count - 1),
                    "{count} {most}"
                );
                assert!(points.is_sorted_by(|a, b| a[0] < b[0]));
            }
        }
    }
}
