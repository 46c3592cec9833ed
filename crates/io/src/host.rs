//! The machine that a run was made on.

/// The processor's own name, or the name of its architecture where it does not tell.
#[must_use]
pub fn cpu_name() -> String {
    brand()
        .or_else(|| {
            std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| from_cpuinfo(&text))
        })
        .unwrap_or_else(|| std::env::consts::ARCH.to_string())
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
fn brand() -> Option<String> {
    let brand = raw_cpuid::CpuId::new().get_processor_brand_string()?;
    Some(brand.as_str().trim().to_string()).filter(|name| !name.is_empty())
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
fn brand() -> Option<String> {
    None
}

/// What Linux says: the key differs from architecture to architecture.
fn from_cpuinfo(text: &str) -> Option<String> {
    ["model name", "cpu model", "Model", "Hardware", "uarch"].iter().find_map(|wanted| {
        text.lines().find_map(|line| {
            let (key, value) = line.split_once(':')?;
            (key.trim() == *wanted && !value.trim().is_empty()).then(|| value.trim().to_string())
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_is_one_line_that_is_not_empty() {
        let name = cpu_name();
        assert!(!name.is_empty() && !name.contains('\n') && name == name.trim());
    }

    #[test]
    fn linux_tells_the_name_under_several_keys() {
        let text = "processor\t: 0\nmodel name\t: Some CPU @ 2 GHz\n\nprocessor\t: 1\n";
        assert_eq!(from_cpuinfo(text).unwrap(), "Some CPU @ 2 GHz");
        assert_eq!(from_cpuinfo("Model\t\t: A board\n").unwrap(), "A board");
        assert_eq!(from_cpuinfo("processor : 0\n"), None);
    }
}
