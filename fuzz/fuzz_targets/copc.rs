#![no_main]

cityweld_fuzz::fuzz_format!("copc");
