#include "firmware/model/square_matrix.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace sidestep {

template <int n>
SquareMatrix<n> inverse(const SquareMatrix<n>& matrix) {
  return matrix.inverse();
}

template <int n>
SquareMatrix<n> cholesky_root(const SquareMatrix<n>& matrix) {
  return matrix.llt().matrixL();
}

template <int n>
bool is_positive_definite(const SquareMatrix<n>& matrix) {
  return Eigen::LLT<SquareMatrix<n>>(matrix).info() == Eigen::Success;
}

Vector3 solve_llt(const Matrix3& matrix, const Vector3& b) {
  return matrix.llt().solve(b);
}

Vector3 solve_ldlt(const Matrix3& matrix, const Vector3& b) {
  return matrix.ldlt().solve(b);
}

TaskVector solve_ldlt(const TaskMatrix& matrix, const TaskVector& b) {
  return matrix.ldlt().solve(b);
}

template <int n>
double least_eigenvalue(const SquareMatrix<n>& matrix) {
  return Eigen::SelfAdjointEigenSolver<SquareMatrix<n>>(matrix, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

template SquareMatrix<3> inverse(const SquareMatrix<3>&);
template SquareMatrix<6> inverse(const SquareMatrix<6>&);
template SquareMatrix<3> cholesky_root(const SquareMatrix<3>&);
template SquareMatrix<6> cholesky_root(const SquareMatrix<6>&);
template bool is_positive_definite(const SquareMatrix<3>&);
template bool is_positive_definite(const SquareMatrix<6>&);
template double least_eigenvalue(const SquareMatrix<3>&);
template double least_eigenvalue(const SquareMatrix<6>&);

}  // namespace sidestep
