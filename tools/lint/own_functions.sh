#!/bin/sh
# What a run's bytes depend on, and what is measured of it, calls none of the C library's functions whose bits depend on
# the processor, nor Eigen's rotations and solutions, which call them or add in an order of their own: portable::
# (host_sim/core/elementary.h), rotation.h and cholesky.h have ours. usage: own_functions.sh. Ends with 1 and one line
# per call.
#
# Others may: pictures, pages, the ground station, fits, training (docs/determinism.md).
set -eu
FUNCTIONS='exp|exp2|expm1|log|log2|log10|log1p|pow|cbrt|a?sin|a?cos|a?tan|atan2|[acs]+inh|a?cosh|a?tanh|hypot|sincos'
FUNCTIONS=$FUNCTIONS'|lerp|fma|[lt]gamma|erf|riemann_zeta'
EIGEN='AngleAxis[df]?|Rotation2D[df]?|slerp|eulerAngles|[lL]lt|ldlt|[pP]artialPivLu'
EIGEN=$EIGEN'|[a-zA-Z]*Householder[qQ]r|[jJ]acobiSvd|normal_distribution|uniform_real_distribution'
WORLDS=$(git ls-files host_sim/core host_sim/campaign host_sim/devices host_sim/grid host_sim/leveling \
  host_sim/physics host_sim/run host_sim/soil_validation host_sim/standin nn/batch nn/data nn/infer nn/surrogate \
  tools/screed/soil | grep -E '\.(cpp|h|inc)$' |
  grep -vE 'elementary|ode_world|_avr|picture')
# shellcheck disable=SC2086  # one word a file
if grep -nE "std::($FUNCTIONS)f?\(|(^|[^:_.a-zA-Z])($FUNCTIONS)f?\(|[:.>]($EIGEN)\b|array\(\)\.($FUNCTIONS)\(\)" \
  $WORLDS |
  grep -vE '^[^:]+:[0-9]+: *(//|/\*)|(void|path) log\('; then
  echo 'own_functions: call portable::, rotation.h or cholesky.h in their place' >&2
  exit 1
fi
