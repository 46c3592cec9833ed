//! Evaluates an equation of state at points read from standard input, for others to check.
//!
//! `cargo run -p lennard-literature --example grid -- thol-2016 < points.csv`, where each line holds
//! `rho,T`, prints a line `rho,T,p,u,cv,speed_of_sound,du_dt,dp_dt,du_drho,dp_drho,phase` for each at
//! full precision; `-- thol-2016 saturation` reads temperatures and prints
//! `T,p,rho_vapor,rho_liquid`.
#![allow(clippy::print_stdout)] // printing is what this program is for

use std::error::Error;
use std::io::BufRead;

use lennard_literature::{EquationOfState, list};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let key = arguments.next().unwrap_or_default();
    let saturation = arguments.next().as_deref() == Some("saturation");
    let equation = list()
        .into_iter()
        .find(|e| e.spec().key == key)
        .ok_or_else(|| format!("no equation of state `{key}`; there are {}", keys()))?;
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let numbers = line
            .split(',')
            .map(|field| field.trim().parse::<f64>())
            .collect::<Result<Vec<_>, _>>()
            .map_err(|e| format!("`{line}`: {e}"))?;
        match numbers[..] {
            [t] if saturation => print_saturation(equation, t)?,
            [rho, t] if !saturation => print_state(equation, rho, t),
            _ => return Err(format!("`{line}`: wrong number of columns").into()),
        }
    }
    Ok(())
}

fn keys() -> String {
    list().map(|e| e.spec().key.clone()).join(", ")
}

fn print_state(equation: &dyn EquationOfState, rho: f64, t: f64) {
    let s = equation.at(rho, t);
    let numbers = [
        s.rho,
        s.temperature,
        s.pressure,
        s.potential_energy,
        s.heat_capacity_volume,
        s.speed_of_sound,
        s.du_dt,
        s.dp_dt,
        s.du_drho,
        s.dp_drho,
    ]
    .map(|x| format!("{x:?}"));
    println!("{},{:?}", numbers.join(","), equation.phase(rho, t));
}

fn print_saturation(equation: &dyn EquationOfState, t: f64) -> Result<(), Box<dyn Error>> {
    let s = equation.saturation(t).ok_or_else(|| format!("no coexistence at {t}"))?;
    println!("{t:?},{:?},{:?},{:?}", s.pressure, s.vapor_density, s.liquid_density);
    Ok(())
}
