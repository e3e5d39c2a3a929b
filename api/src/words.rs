//! Names on the wire as words for people. The page has the same rule (`server/page/src/format/words.ts`),
//! held to the same list (`tests/data/words.json`).

/// A name as words: `strain_at_max_force` is `strain at max force`, and `modulus_at_2_5_percent`
/// `modulus at 2.5 %`.
pub fn words(name: &str) -> String {
    let mut words: Vec<String> = Vec::new();
    for word in name.split('_') {
        if word == "percent"
            && let Some((number, first)) = number_at_end(&words)
        {
            words.truncate(first);
            words.push(format!("{number} %"));
        } else {
            words.push(word.to_owned());
        }
    }
    words.join(" ")
}

/// The number that words end in after `at`, whole or in two parts, and which of them is its first.
fn number_at_end(words: &[String]) -> Option<(String, usize)> {
    let at = words.iter().rposition(|word| word == "at")?;
    let parts = &words[at + 1..];
    let is_number = |part: &String| part.bytes().all(|byte| byte.is_ascii_digit());
    let fits = (1..=2).contains(&parts.len()) && parts.iter().all(is_number);
    fits.then(|| (parts.join("."), at + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_words_as_on_the_page() {
        let cases = include_str!("../../tests/data/words.json");
        let cases: Vec<[String; 2]> = serde_json::from_str(cases).unwrap();
        for [name, expected] in cases {
            assert_eq!(words(&name), expected);
        }
    }
}
