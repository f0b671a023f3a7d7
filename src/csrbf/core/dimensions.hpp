#pragma once

/// X(Dim) for every dimension in which the library instantiates its templates on `int Dim`. Their definitions are in
/// source files; every further dimension needs an entry here.
#define CSRBF_FOR_EACH_DIM(X) X(1) X(2) X(3) X(4) X(5) X(6)
