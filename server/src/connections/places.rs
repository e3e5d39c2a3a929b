//! Places for connections, of one address and in all.
use std::collections::{BTreeMap, HashMap};
use std::net::{IpAddr, Ipv6Addr};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use super::limits::ConnectionLimits;
use super::standing::Standing;

/// Bits of an IPv6 address that name a network: one client may have all of the others.
const NETWORK_BITS: u32 = 64;

/// The places.
#[derive(Clone, Debug)]
pub(super) struct Places(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    in_all: usize,
    per_address: usize,
    start: Instant,
    taken: Mutex<Taken>,
}

#[derive(Debug, Default)]
struct Taken {
    /// Number of the next connection.
    next: u64,
    count: usize,
    by_address: HashMap<IpAddr, BTreeMap<u64, Arc<Standing>>>,
}

/// A connection's place, until dropped.
#[derive(Debug)]
pub(super) struct Place {
    places: Places,
    address: IpAddr,
    number: u64,
    pub(super) standing: Arc<Standing>,
}

impl Places {
    pub(super) fn new(limits: &ConnectionLimits) -> Self {
        Self(Arc::new(Inner {
            in_all: limits.in_all.max(1),
            per_address: limits.per_address.max(1),
            start: Instant::now(),
            taken: Mutex::default(),
        }))
    }

    /// A place for a connection from `address`, if need be that of another which waits for its client.
    /// `None` when the server is at work for all that have one.
    pub(super) fn take(&self, address: IpAddr) -> Option<Place> {
        let address = client(address);
        let mut taken = self.lock();
        let own = taken.by_address.get(&address).map_or(0, BTreeMap::len);
        if own >= self.0.per_address && !taken.displace(Some(address)) {
            return None;
        }
        if taken.count >= self.0.in_all && !taken.displace(None) {
            return None;
        }
        let number = taken.next;
        taken.next += 1;
        taken.count += 1;
        let standing = Arc::new(Standing::new(self.0.start));
        let of_address = taken.by_address.entry(address).or_default();
        of_address.insert(number, standing.clone());
        Some(Place {
            places: self.clone(),
            address,
            number,
            standing,
        })
    }

    /// Ends the connection whose client has been waited for longest; whether there was one.
    pub(super) fn displace_one(&self) -> bool {
        self.lock().displace(None)
    }

    /// Connections at present.
    pub(super) fn count(&self) -> usize {
        self.lock().count
    }

    fn lock(&self) -> MutexGuard<'_, Taken> {
        self.0.taken.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Taken {
    /// Ends the connection of `address`, or of any, whose client has been waited for longest.
    fn displace(&mut self, address: Option<IpAddr>) -> bool {
        let candidates = self.by_address.iter();
        let candidates = candidates.filter(|(of, _)| address.is_none_or(|address| address == **of));
        let victim = candidates
            .flat_map(|(of, places)| places.iter().map(move |place| (of, place)))
            .filter_map(|(of, (number, standing))| Some((standing.waiting_since()?, *number, *of)))
            .min();
        let Some((_, number, of)) = victim else {
            return false;
        };
        if let Some(standing) = self.free(of, number) {
            standing.displaced.cancel();
        }
        metrics::counter!("loadframe_connections_ended_total", "cause" => "displaced").increment(1);
        true
    }

    fn free(&mut self, address: IpAddr, number: u64) -> Option<Arc<Standing>> {
        let places = self.by_address.get_mut(&address)?;
        let standing = places.remove(&number)?;
        if places.is_empty() {
            self.by_address.remove(&address);
        }
        self.count -= 1;
        Some(standing)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.places.lock().free(self.address, self.number);
    }
}

/// The address that stands for a client.
pub(crate) fn client(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V4(address) => IpAddr::V4(address),
        IpAddr::V6(address) => {
            let network = u128::from(address) >> NETWORK_BITS << NETWORK_BITS;
            IpAddr::V6(Ipv6Addr::from(network))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::standing::Phase;
    use super::*;

    fn places(in_all: usize, per_address: usize) -> Places {
        Places::new(&ConnectionLimits {
            per_address,
            ..ConnectionLimits::with_places(in_all)
        })
    }

    fn address(last: u8) -> IpAddr {
        IpAddr::from([192, 0, 2, last])
    }

    #[test]
    fn a_new_connection_takes_the_place_of_the_one_waited_for_longest() {
        let places = places(10, 3);
        let busy = places.take(address(1)).expect("a place");
        busy.standing.enter(Phase::Answer);
        let first = places.take(address(1)).expect("a place");
        std::thread::sleep(std::time::Duration::from_millis(1));
        let second = places.take(address(1)).expect("a place");
        assert!(!first.standing.displaced.is_cancelled());
        let third = places.take(address(1)).expect("that of the first");
        assert!(first.standing.displaced.is_cancelled());
        assert!(!busy.standing.displaced.is_cancelled());
        assert_eq!(places.count(), 3);
        // an end that was told already frees no second place
        drop(first);
        assert_eq!(places.count(), 3);
        drop((busy, second, third));
        assert_eq!(places.count(), 0);
        assert!(places.lock().by_address.is_empty());
    }

    #[test]
    fn nobody_is_displaced_for_whom_the_server_is_at_work() {
        let places = places(2, 2);
        let busy = [1, 2].map(|last| places.take(address(last)).expect("a place"));
        for place in &busy {
            place.standing.enter(Phase::Answer);
        }
        assert!(places.take(address(3)).is_none());
        // a client that does not take its answer is one that is waited for
        busy[1].standing.wait_to_write();
        assert!(places.take(address(3)).is_some());
        assert!(busy[1].standing.displaced.is_cancelled());
    }

    #[test]
    fn one_address_displaces_only_its_own() {
        let places = places(10, 1);
        let other = places.take(address(1)).expect("a place");
        let own = places.take(address(2)).expect("a place");
        assert!(places.take(address(2)).is_some());
        assert!(own.standing.displaced.is_cancelled());
        assert!(!other.standing.displaced.is_cancelled());
    }

    #[test]
    fn a_network_of_ipv6_is_one_client() {
        let of = |text: &str| client(text.parse().expect("an address"));
        assert_eq!(of("2001:db8:1:2::1"), of("2001:db8:1:2:ffff::9"));
        assert_ne!(of("2001:db8:1:2::1"), of("2001:db8:1:3::1"));
        assert_eq!(of("::ffff:192.0.2.1"), of("192.0.2.1"));
    }
}
