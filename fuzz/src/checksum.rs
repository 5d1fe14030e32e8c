//! Check sums, so that damage reaches what lies behind them.

/// CRC-32C (Castagnoli), of E57's pages; bits reversed.
pub const CASTAGNOLI: u32 = 0x82F6_3B78;
/// The check sum of bytes, bit by bit: files here are small.
pub fn crc32(polynomial: u32, bytes: &[u8]) -> u32 {
    let byte_in = |sum: u32, byte: &u8| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| (sum >> 1) ^ (polynomial & (sum & 1).wrapping_neg()))
    };
    !bytes.iter().fold(u32::MAX, byte_in)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check values of the catalogue of parametrised CRC algorithms.
    #[test]
    fn sums_are_those_of_the_catalogue() {
        assert_eq!(crc32(CASTAGNOLI, b"123456789"), 0xE306_9283);
    }
}
