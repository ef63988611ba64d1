// results.h5: the whole outcome for people who compute on. SI; every dataset has the attributes `units` and
// `long_name`; bins and variables are dimension scales. Layout:
//   /config/{verbatim,resolved}       the study as written, and every value used, given or default
//   /bins/y_m                         scale: bin centres
//   /variables/{name,unit,value,low,high,free}   scale: name
//   /evaluations/*                    one row each: kinematic, straight, predicted, confirmations
//   /history/*                        the search, one row per step
//   /result/*                         target, confirmed profile and band, drift, map, partition, scalars
//   /layers/*                         one row a layer, where several are laid: profile, misfit, volumes
//   /extrapolated/*                   strips and carried errors of a design for a machine nobody spread
//   /provenance/*                     version, compiler, host, seed, termination
#pragma once
#include <string>

#include "optimise/study.h"
#include "optimise/study_result.h"

namespace gradwright {

/// Writes aside and renames. Throws std::runtime_error naming the path.
void write_results_file(const Study& study, const StudyResult& result, const std::string& path);

}  // namespace gradwright
