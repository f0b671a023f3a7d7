#pragma once

/// X(Dim) for every dimension in which the templates on `int Dim` of the library are instantiated. Their definitions
/// live in source files; more dimensions need one more entry here.
#define CSRBF_FOR_EACH_DIM(X) X(1) X(2) X(3) X(4) X(5) X(6)
