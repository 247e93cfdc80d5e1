//! Content security policy of a page: it runs its own scripts and loads nothing.

/// Policy of a page with these scripts and this style. The policy contains the hashes of the scripts and the style. So no other
/// text can run as a script or act as a style.
pub(super) fn policy(scripts: &[&str], style: &str) -> String {
    let hash = |text: &str| {
        format!(
            "'sha256-{}'",
            base64(&hmac_sha256::Hash::hash(text.as_bytes()))
        )
    };
    let scripts: Vec<String> = scripts.iter().map(|script| hash(script)).collect();
    let scripts = if scripts.is_empty() {
        "'none'".to_owned()
    } else {
        scripts.join(" ")
    };
    format!(
        "default-src 'none'; base-uri 'none'; form-action 'none'; style-src {}; script-src {scripts}",
        hash(style)
    )
}

/// Base64 text with padding (RFC 4648, section 4).
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let byte = |i: usize| u32::from(chunk.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for place in 0..4 {
            let digit = (bits >> (18 - 6 * place)) & 63;
            text.push(if place <= chunk.len() {
                DIGITS[digit as usize] as char
            } else {
                '='
            });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_the_standard() {
        for (plain, coded) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    /// Hash of the example script in the CSP specification, level 2, section 4.2.5.
    #[test]
    fn scripts_are_named_by_their_hashes() {
        let policy = policy(&["alert('Hello, world.');"], "");
        assert!(policy.ends_with("'sha256-qznLcsROx4GACP2dm0UCKCzCG+HiZ1guq6ZZDob/Tng='"));
    }
}
