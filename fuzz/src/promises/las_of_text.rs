//! The least LAS file that names a reference system: LAS 1.4, one record with well-known text, two points of format 6.

const HEADER: usize = 375;
const RECORD_HEAD: usize = 54;
const POINT: usize = 30;
/// What the length of a record can hold.
const LONGEST_TEXT: usize = 65_535;

pub fn las_of_text(text: &[u8]) -> Vec<u8> {
    let text = &text[..text.len().min(LONGEST_TEXT)];
    let mut file = vec![0; HEADER];
    let mut put = |at: usize, bytes: &[u8]| file[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, b"LASF");
    // The system is told as text.
    put(6, &16u16.to_le_bytes());
    put(24, &[1, 4]);
    put(94, &(HEADER as u16).to_le_bytes());
    put(96, &((HEADER + RECORD_HEAD + text.len()) as u32).to_le_bytes());
    put(100, &1u32.to_le_bytes());
    put(104, &[6]);
    put(105, &(POINT as u16).to_le_bytes());
    for axis in 0..3 {
        put(131 + 8 * axis, &0.01f64.to_le_bytes());
    }
    put(247, &2u64.to_le_bytes());
    let mut record = [0; RECORD_HEAD];
    record[2..17].copy_from_slice(b"LASF_Projection");
    record[18..20].copy_from_slice(&2112u16.to_le_bytes());
    record[20..22].copy_from_slice(&(text.len() as u16).to_le_bytes());
    let mut points = [0; 2 * POINT];
    points[POINT] = 100;
    [&file[..], &record, text, &points].concat()
}
