// File: cvode_handles.h
//
// Owners of what SUNDIALS allocates, for the references that use CVODE.
//
//   CvodeMemory cvode(CVodeCreate(CV_BDF, context));
//
// Each frees what it owns; not thread-safe.
#pragma once

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <memory>

namespace tactus::internal {

struct ContextDelete {
  void operator()(_SUNContext* context) const { SUNContext_Free(&context); }
};
struct VectorDelete {
  void operator()(_generic_N_Vector* vector) const { N_VDestroy(vector); }
};
struct MatrixDelete {
  void operator()(_generic_SUNMatrix* matrix) const { SUNMatDestroy(matrix); }
};
struct LinearSolverDelete {
  void operator()(_generic_SUNLinearSolver* solver) const {
    SUNLinSolFree(solver);
  }
};
struct CvodeDelete {
  void operator()(void* memory) const { CVodeFree(&memory); }
};

using CvodeContext = std::unique_ptr<_SUNContext, ContextDelete>;
using CvodeVector = std::unique_ptr<_generic_N_Vector, VectorDelete>;
using CvodeMatrix = std::unique_ptr<_generic_SUNMatrix, MatrixDelete>;
using CvodeLinearSolver =
    std::unique_ptr<_generic_SUNLinearSolver, LinearSolverDelete>;
using CvodeMemory = std::unique_ptr<void, CvodeDelete>;

}  // namespace tactus::internal
