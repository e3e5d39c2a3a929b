//! Where messages may go: to addresses of the open internet, and to networks that the server was told of.
//!
//! A name is looked up, every address it leads to is looked at, and the message goes to these very
//! addresses: a name that leads elsewhere a moment later, or an answer that redirects, leads nowhere.
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};

use ipnet::{IpNet, Ipv4Net, Ipv6Net};
use url::{Host, Url};

/// Networks that are not of the open internet (IANA's registries of special-purpose addresses, RFC 6890
/// and its updates), and multicast.
const SPECIAL_V4: [([u8; 4], u8); 16] = [
    ([0, 0, 0, 0], 8),
    ([10, 0, 0, 0], 8),
    ([100, 64, 0, 0], 10),
    ([127, 0, 0, 0], 8),
    ([169, 254, 0, 0], 16),
    ([172, 16, 0, 0], 12),
    ([192, 0, 0, 0], 24),
    ([192, 0, 2, 0], 24),
    ([192, 31, 196, 0], 24),
    ([192, 52, 193, 0], 24),
    ([192, 88, 99, 0], 24),
    ([192, 168, 0, 0], 16),
    ([198, 18, 0, 0], 15),
    ([198, 51, 100, 0], 24),
    ([203, 0, 113, 0], 24),
    ([224, 0, 0, 0], 3),
];
/// Of the sixth version only what is given out for the open internet, less what carries or documents.
const OPEN_V6: ([u16; 8], u8) = ([0x2000, 0, 0, 0, 0, 0, 0, 0], 3);
const SPECIAL_V6: [([u16; 8], u8); 4] = [
    ([0x2001, 0, 0, 0, 0, 0, 0, 0], 23),
    ([0x2001, 0xdb8, 0, 0, 0, 0, 0, 0], 32),
    // 6to4 holds an address of the fourth version, whatever that is
    ([0x2002, 0, 0, 0, 0, 0, 0, 0], 16),
    ([0x3fff, 0, 0, 0, 0, 0, 0, 0], 20),
];

/// Where messages may go besides the open internet.
#[derive(Clone, Debug, Default)]
pub struct Addresses {
    allowed: Vec<IpNet>,
}

/// Why no message goes there.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum AddressError {
    #[error(
        "this is no address of http or https with a host, without a name and password, a fragment, spaces or backslashes"
    )]
    Form,
    #[error("the host {0:?} cannot be found")]
    Unknown(String),
    #[error(
        "the host {host:?} leads to {address}, which is a private address; the server takes it with --webhook-network"
    )]
    Private { host: String, address: IpAddr },
}

/// An address that was looked at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Destination {
    pub url: Url,
    pub host: String,
    pub sockets: Vec<SocketAddr>,
}

impl Addresses {
    /// The open internet, and these networks.
    pub fn new(allowed: Vec<IpNet>) -> Self {
        Self { allowed }
    }

    /// Looks an address up, and at where it leads.
    ///
    /// # Errors
    /// [`AddressError`]; one private address among several is enough.
    pub async fn look_up(&self, text: &str) -> Result<Destination, AddressError> {
        // the parser would read these as something else, or leave them out
        let is_misread = |c: char| c.is_control() || c.is_whitespace() || c == '\\';
        if text.contains(is_misread) {
            return Err(AddressError::Form);
        }
        let url = Url::parse(text).map_err(|_| AddressError::Form)?;
        let is_plain = url.username().is_empty()
            && url.password().is_none()
            && url.fragment().is_none()
            && url.port() != Some(0);
        if !matches!(url.scheme(), "http" | "https") || !is_plain {
            return Err(AddressError::Form);
        }
        let host = url.host_str().ok_or(AddressError::Form)?.to_owned();
        let port = url.port_or_known_default().ok_or(AddressError::Form)?;
        let sockets: Vec<SocketAddr> = match url.host() {
            Some(Host::Ipv4(address)) => vec![(address, port).into()],
            Some(Host::Ipv6(address)) => vec![(address, port).into()],
            _ => match tokio::net::lookup_host((host.as_str(), port)).await {
                Ok(found) => found.collect(),
                Err(_) => Vec::new(),
            },
        };
        if sockets.is_empty() {
            return Err(AddressError::Unknown(host));
        }
        match sockets.iter().find(|socket| !self.takes(socket.ip())) {
            None => Ok(Destination { url, host, sockets }),
            Some(socket) => Err(AddressError::Private {
                host,
                address: socket.ip(),
            }),
        }
    }

    fn takes(&self, address: IpAddr) -> bool {
        let address = address.to_canonical();
        is_open(address)
            || self
                .allowed
                .iter()
                .any(|network| network.contains(&address))
    }
}

fn is_open(address: IpAddr) -> bool {
    let v4 = |(network, bits): &([u8; 4], u8)| Ipv4Net::new(Ipv4Addr::from(*network), *bits);
    let v6 = |(network, bits): &([u16; 8], u8)| Ipv6Net::new(Ipv6Addr::from(*network), *bits);
    match address {
        IpAddr::V4(address) => {
            let is_of = |network| v4(network).is_ok_and(|of| of.contains(&address));
            !SPECIAL_V4.iter().any(is_of)
        }
        IpAddr::V6(address) => {
            let is_of = |network| v6(network).is_ok_and(|of| of.contains(&address));
            is_of(&OPEN_V6) && !SPECIAL_V6.iter().any(is_of)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn only_the_open_internet_and_what_is_allowed_is_told() {
        let addresses = Addresses::new(vec!["10.7.0.0/16".parse().expect("a network")]);
        for open in [
            "http://8.8.8.8/",
            "https://[2606:4700::1111]/x?y",
            "http://10.7.1.2:8080/",
            "http://[::ffff:10.7.1.2]/",
        ] {
            assert!(addresses.look_up(open).await.is_ok(), "{open}");
        }
        for private in [
            "http://127.0.0.1/",
            "http://127.1/",
            "http://2130706433/",
            "http://0x7f.0.0.1/",
            "http://0/",
            "http://10.8.0.1/",
            "http://172.16.0.1/",
            "http://172.31.255.255/",
            "http://192.168.1.1/",
            "http://169.254.169.254/latest/meta-data",
            "http://100.64.0.1/",
            "http://[::1]/",
            "http://[::]/",
            "http://[::ffff:127.0.0.1]/",
            "http://[fe80::1]/",
            "http://[fd00::1]/",
            "http://[64:ff9b::7f00:1]/",
            "http://[2002:7f00:1::]/",
            "http://224.0.0.1/",
            "http://255.255.255.255/",
            "http://localhost/",
            "http://192.0.2.1/",
            "http://[2001:db8::1]/",
        ] {
            let refused = addresses.look_up(private).await;
            assert!(
                matches!(refused, Err(AddressError::Private { .. })),
                "{private} {refused:?}"
            );
        }
        for wrong in [
            "",
            "ftp://8.8.8.8/",
            "file:///etc/passwd",
            "http://",
            "http://a@8.8.8.8/",
            "http://:b@8.8.8.8/",
            "gopher://8.8.8.8",
            "http://8.8.8.8:0/",
            "http://8.8.8.8/#fragment",
            "http://8.8.8.8/\r\nhost: inner",
            " http://8.8.8.8/",
            "http://8.8.8.8\\@127.0.0.1/",
        ] {
            assert_eq!(
                addresses.look_up(wrong).await,
                Err(AddressError::Form),
                "{wrong}"
            );
        }
        let unknown = addresses.look_up("http://no.such.host.invalid/").await;
        assert!(
            matches!(unknown, Err(AddressError::Unknown(_))),
            "{unknown:?}"
        );
    }
}
