//! Order statistics of a list of numbers.

/// The middle value; of two middle ones the upper. `None` of an empty list.
pub fn median(values: &mut [f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// The value below which this share of the others lies, by the nearest rank; the list is left in another order.
pub fn quantile(values: &mut [f64], share: f64) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    let rank = ((share * last as f64).round() as usize).min(last);
    Some(*values.select_nth_unstable_by(rank, f64::total_cmp).1)
}

#[cfg(test)]
mod tests;
