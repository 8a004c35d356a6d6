#pragma once

#include "firmware/model/types.h"

namespace sidestep {

template <int n>
using SquareMatrix = Eigen::Matrix<double, n, n>;

/// Decompositions of 3 x 3 and 6 x 6 matrices, on the stack. They stand in one file because every file that
/// instantiates Eigen's templates itself takes seconds longer to compile.

/// The inverse of an invertible matrix.
template <int n>
SquareMatrix<n> inverse(const SquareMatrix<n>& matrix);

/// The lower triangular L with L L^T = matrix, for a symmetric positive definite matrix.
template <int n>
SquareMatrix<n> cholesky_root(const SquareMatrix<n>& matrix);

/// Whether a symmetric matrix has a Cholesky decomposition.
template <int n>
bool is_positive_definite(const SquareMatrix<n>& matrix);

/// x with matrix x = b, for a symmetric positive definite matrix, by a Cholesky decomposition.
Vector3 solve_llt(const Matrix3& matrix, const Vector3& b);

/// x with matrix x = b, for a symmetric positive semidefinite matrix, by an LDL^T decomposition. 3 x 3, or sized at run
/// time with at most 6 x 6.
Vector3 solve_ldlt(const Matrix3& matrix, const Vector3& b);
TaskVector solve_ldlt(const TaskMatrix& matrix, const TaskVector& b);

/// The least eigenvalue of a symmetric matrix.
template <int n>
double least_eigenvalue(const SquareMatrix<n>& matrix);

}  // namespace sidestep
