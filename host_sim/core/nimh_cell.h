// The discharge curve of a NiMH cell: what its voltage says about its charge, and the other way
// round.
//
// The ends are those of VARTA Microbattery's NiMH data sheets (section "Definitions"): an
// open-circuit voltage of 1.4 V when full and 1.25 V on average, 1.0 V at the end of a discharge in
// five hours. Between them the flat curve that such data sheets draw of that discharge, read off at
// three points: the first tenth takes the voltage to 1.3 V, from 1.2 V on it falls off.
#pragma once

namespace screed {

/// Share of the charge, 0 empty .. 1 full, at a voltage: 0 below 1.0 V, 1 above 1.4 V.
double nimh_charge(double cell_v);

/// Voltage at a share of the charge; above 1 that of 1. What is drawn from an empty cell, below 0,
/// takes it from 1.0 V to nothing within a twentieth of its charge (assumed: such cells are
/// spoilt).
double nimh_cell_v(double charge);

}  // namespace screed
