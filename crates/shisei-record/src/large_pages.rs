//! Long series in large pages of memory, which the system hands out 512 times as fast as small ones.
#![cfg_attr(target_os = "linux", allow(unsafe_code))] // a hint on memory that is ours; what it holds stays as it is

/// Size and alignment of a large page, bytes.
#[cfg(target_os = "linux")]
const LARGE: usize = 1 << 21;

/// Asks for large pages for what a vector has room for and does not hold yet. Where there are none nothing is lost.
#[cfg(target_os = "linux")]
pub(crate) fn ask_for<T>(values: &mut Vec<T>) {
    let room = values.spare_capacity_mut();
    let bytes = size_of_val(room);
    let start = room.as_mut_ptr().cast::<u8>();
    let before = start.align_offset(LARGE);
    let whole = bytes.saturating_sub(before) / LARGE * LARGE;
    if whole > 0 {
        // SAFETY: the range lies in the vector's own memory, and this advice changes nothing of what is in it.
        let _ = unsafe {
            rustix::mm::madvise(start.wrapping_add(before).cast(), whole, rustix::mm::Advice::LinuxHugepage)
        };
    }
}

/// Other systems are not asked.
#[cfg(not(target_os = "linux"))]
pub(crate) fn ask_for<T>(_: &mut Vec<T>) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vector_keeps_what_it_holds() {
        for length in [0, 1, 100_000, 3_000_000] {
            let mut values: Vec<f64> = (0..1000).map(f64::from).collect();
            values.reserve_exact(length);
            ask_for(&mut values);
            values.extend((1000..1000 + length as u32).map(f64::from));
            assert!(values.iter().enumerate().all(|(k, v)| *v == k as f64));
        }
    }
}
