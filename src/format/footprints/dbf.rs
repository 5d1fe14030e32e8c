//! dBASE tables beside Shapefiles: the numbers and the text of single fields.
//!
//! A header of 32 bytes, one of 32 bytes for each field up to a 0x0D, then records of fixed length, each a deletion mark and texts
//! (dBASE III and later; the Shapefile's own description leaves the table to them).

use crate::format::surface_error::{Place, SurfaceError};

const HEADER_BYTES: usize = 32;
const FIELD_BYTES: usize = 32;
const FIELDS_END: u8 = 0x0D;

/// A table over its bytes.
#[derive(Debug)]
pub(super) struct Table<'a> {
    fields: Vec<Field>,
    /// Records, one after the other.
    records: &'a [u8],
    record_bytes: usize,
}

#[derive(Clone, Debug)]
struct Field {
    name: String,
    /// Place and length within a record.
    start: usize,
    length: usize,
    kind: u8,
}

impl Table<'_> {
    pub fn of(bytes: &[u8]) -> Result<Table<'_>, SurfaceError> {
        let cut = || SurfaceError::whole("the table (.dbf) is cut off; get it again");
        let header = bytes.get(..HEADER_BYTES).ok_or_else(cut)?;
        let half = |at: usize| usize::from(u16::from_le_bytes([header[at], header[at + 1]]));
        let count = u32::from_le_bytes([header[4], header[5], header[6], header[7]]) as usize;
        let (header_bytes, record_bytes) = (half(8), half(10));
        let listed = bytes.get(HEADER_BYTES..header_bytes).ok_or_else(cut)?;
        let mut fields = Vec::new();
        let mut start = 1;
        for field in listed.chunks_exact(FIELD_BYTES).take_while(|field| field[0] != FIELDS_END) {
            let name = field[..11].split(|&byte| byte == 0).next().unwrap_or_default();
            let length = usize::from(field[16]);
            let name = String::from_utf8_lossy(name).trim().to_owned();
            fields.push(Field { name, start, length, kind: field[11] });
            start += length;
        }
        if start > record_bytes {
            let problem =
                format!("the table (.dbf) has records of {record_bytes} bytes and fields of {start}; write it again");
            return Err(SurfaceError::at(Place::Byte(10), problem));
        }
        let length = count.checked_mul(record_bytes).and_then(|length| header_bytes.checked_add(length));
        let records = bytes.get(header_bytes..length.ok_or_else(cut)?).ok_or_else(cut)?;
        Ok(Table { fields, records, record_bytes })
    }

    pub fn count(&self) -> usize {
        self.records.len() / self.record_bytes
    }

    /// Names of the fields with numbers.
    pub fn numeric(&self) -> Vec<String> {
        self.numeric_fields().map(|field| field.name.clone()).collect()
    }

    fn numeric_fields(&self) -> impl Iterator<Item = &Field> {
        // `B` is a number of eight bytes, or, in other dialects, a reference.
        let is_numeric = |field: &&Field| match field.kind {
            b'N' | b'F' => true,
            b'I' | b'+' => field.length == 4,
            b'O' | b'B' => field.length == 8,
            _ => false,
        };
        self.fields.iter().filter(is_numeric)
    }

    /// Value of a numeric field, by its place among them; nothing where it is empty or no number.
    pub fn number(&self, record: usize, numeric: usize) -> Option<f64> {
        let field = self.numeric_fields().nth(numeric)?;
        let bytes = self.bytes(record, field)?;
        match field.kind {
            b'I' | b'+' => Some(f64::from(i32::from_le_bytes(bytes.try_into().ok()?))),
            b'O' | b'B' => Some(f64::from_le_bytes(bytes.try_into().ok()?)),
            _ => fast_float2::parse(bytes.trim_ascii()).ok(),
        }
        .filter(|value: &f64| value.is_finite())
    }

    /// Whether the record is marked as deleted.
    pub fn is_deleted(&self, record: usize) -> bool {
        self.records.get(record * self.record_bytes) == Some(&b'*')
    }

    fn bytes(&self, record: usize, field: &Field) -> Option<&[u8]> {
        let start = record.checked_mul(self.record_bytes)? + field.start;
        self.records.get(start..start + field.length)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::dbf;
    use super::*;

    #[test]
    fn numbers_are_read_in_every_type_that_holds_them() {
        let fields = [("text", b'N', 6), ("float", b'F', 6), ("long", b'I', 4), ("name", b'C', 3), ("memo", b'B', 3)];
        let rows = [
            [" ", "  -1.5", "   2e3", "\u{1}\0\0\0", "abc", "xyz"].concat(),
            ["*", "******", "  nan ", "\0\0\0\0", "   ", "xyz"].concat(),
        ];
        let bytes = dbf(&fields, &rows.each_ref().map(String::as_str));
        let table = Table::of(&bytes).unwrap();
        assert_eq!((table.count(), table.numeric()), (2, ["text", "float", "long"].map(str::to_owned).to_vec()));
        assert_eq!([0, 1, 2, 3].map(|field| table.number(0, field)), [Some(-1.5), Some(2000.0), Some(1.0), None]);
        assert_eq!([0, 1, 2].map(|field| table.number(1, field)), [None, None, Some(0.0)]);
        assert_eq!([0, 1, 9].map(|row| table.is_deleted(row)), [false, true, false]);
    }

    #[test]
    fn a_table_that_lies_is_refused() {
        let good = dbf(&[("h", b'N', 3)], &[" 1.0"]);
        for (at, byte) in [(4, 9), (8, 255), (10, 1), (10, 0), (48, 200)] {
            let mut bytes = good.clone();
            bytes[at] = byte;
            assert!(Table::of(&bytes).is_err(), "byte {at}");
        }
        assert!(Table::of(&good[..good.len() - 1]).is_err());
    }
}
