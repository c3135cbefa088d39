#pragma once

#include <nanobind/nanobind.h>

namespace aloft::python {

/// Parts of the module aloft._core.
void define_observer(nanobind::module_& m);
void define_results(nanobind::module_& m);

}  // namespace aloft::python
