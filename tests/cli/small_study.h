#pragma once
#include <string>

/// A strip of two hundred soft grains: seconds a spread.
inline const std::string kSmallStudy = R"([study]
name = "a strip of seconds"
[machine]
dispenser = { length = "0.35 mm", width = "0.5 mm", depth = "1 mm" }
platform  = { length = "0.35 mm" }
land = "0.1 mm"
second_land = "0.3 mm"
blade = { thickness = "0.1 mm" }
[process]
blade_speed = "200 mm/s"
allow_starved = true
[powder.A]
material = "SS17-4PH"
size = { D10 = "32 um", D50 = "40 um", D90 = "50 um", cut_low = "30 um", cut_high = "55 um" }
[powder.B]
material = "IN718"
[interaction]
work_of_adhesion = "0 J/m2"
[target]
shape = "linear"
from = { y = "0.15 mm", gi = 0.0 }
to   = { y = "0.35 mm", gi = 1.0 }
footprint = { x = ["0.05 mm", "0.35 mm"] }
bin_width = "50 um"
[design_space]
partition = { family = "straight" }
dosage_factor = 3.0
[numerics]
softening = 4e-5
bed_depth = "40 um"
reductions = ["strip_map"]
strip_width = "0.23 mm"
)";
