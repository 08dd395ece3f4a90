// SPDX-License-Identifier: Apache-2.0
#include "mechanics/tree_terms.hpp"

#include "mechanics/tree.hpp"

namespace aussois {
namespace {

// X(V), so that X(V) W = V x W for twists (v, omega) at one point.
Mat6 cross(const Vec6& V) {
  Mat6 out;
  out << skew(V.tail<3>()), skew(V.head<3>()), Mat3::Zero(), skew(V.tail<3>());
  return out;
}
// G(f), so that G(f) V = -X(V)^T f (TREE-6).
Mat6 cross_of_wrench(const Vec6& f) {
  Mat6 out;
  out << Mat3::Zero(), -skew(f.head<3>()), -skew(f.head<3>()), -skew(f.tail<3>());
  return out;
}

// The inertia of a body at a point, as seen in the world.
Mat6 inertia_at(const RigidBody& body, const SE3& g, const Vec3& origin) {
  const Mat3 R = g.R.toRotationMatrix(), c = skew(g.p - origin), mc = body.mass * c;
  Mat6 out;
  out << body.mass * Mat3::Identity(), -mc, mc, R * body.inertia * R.transpose() - mc * c;
  return out;
}

// What an axis carries: sums over links.
struct Composite {
  Mat6 I = Mat6::Zero(), B = Mat6::Zero();
  Vec6 weight = Vec6::Zero(), force = Vec6::Zero();  // force: I A - X^T I V

  Composite& operator+=(const Composite& other) {
    I += other.I, B += other.B, weight += other.weight, force += other.force;
    return *this;
  }
};

Composite of_link(const RigidBody& body, const SE3& g, const Vec3& origin, const Vec3& gravity, const Vec6& V,
                  const Vec6& A) {
  Composite out{.I = inertia_at(body, g, origin)};
  const Vec6 P = out.I * V;
  const Mat6 X = cross(V);
  out.B = 0.5 * (cross_of_wrench(P) - X.transpose() * out.I - out.I * X);
  out.weight << body.mass * gravity, (g.p - origin).cross(body.mass * gravity);
  out.force = out.I * A - X.transpose() * P;
  return out;
}

// A column of the Jacobian: an axis, or one of the six motions of a dynamic base.
struct Column {
  Vec6 S = Vec6::Zero(), rates = Vec6::Zero();  // rates: S' + Psi (TREE-5)
  int place = 0;                                // among the terms
};

// The six of a base: translations along the axes of the world, rotations about its own.
std::vector<Column> base_columns(const Mat3& R, const Vec3& omega, const Vec3& v) {
  std::vector<Column> out(6);
  for (int i = 0; i < 6; ++i) {
    out[i].place = i;
    if (i < 3) {
      out[i].S[i] = 1;
      continue;
    }
    const Vec3 axis = R.col(i - 3);
    out[i].S.tail<3>() = axis;
    out[i].rates << 2 * v.cross(axis), omega.cross(axis);
  }
  return out;
}

// What a column and each of those that carry it give to mass and C (TREE-3), (TREE-5).
class Pairs {
 public:
  Pairs(const Column& of, const Composite& carried, TreeTerms& out)
      : i_(of.place),
        momentum_(carried.I * of.S),
        force_(2 * (carried.B * of.S) + carried.I * of.rates),
        turned_(2 * (carried.B.transpose() * of.S)),
        out_(out) {}
  void add(const Column& by) {
    const int j = by.place;
    out_.mass(i_, j) = out_.mass(j, i_) = by.S.dot(momentum_);
    out_.C(j, i_) = by.S.dot(force_);
    out_.C(i_, j) = by.S.dot(turned_) + by.rates.dot(momentum_);
  }

 private:
  int i_;
  Vec6 momentum_, force_, turned_;
  TreeTerms& out_;
};

}  // namespace

TreeTerms tree_terms(const Model& model, BlockId block, const State& state) {
  const Coordinates& coordinates = model.coordinates[block];
  const Tree& tree = coordinates.tree;
  const bool floats = tree.base && is_dynamic(model.bodies[tree.base]);
  const int speed = first_speed(model, block), first = floats ? 6 : 0, count = first + coordinates.size;
  const Vec3 origin = tree_origin(tree, state.g);
  const MatX zero = MatX::Zero(count, count);
  TreeTerms out{.mass = zero, .gravity = VecX::Zero(count), .gyroscopic = VecX::Zero(count), .C = zero};
  for (int i = 0; i < first; ++i) out.velocity.push_back(first_velocity(tree.base) + i);
  for (int i = 0; i < coordinates.size; ++i) out.velocity.push_back(speed + i);

  Vec6 V_0 = Vec6::Zero(), A_0 = Vec6::Zero();
  std::vector<Column> base;
  if (floats) {
    const Mat3 R = state.g[tree.base].R.toRotationMatrix();
    const Vec3 v = linear_part(state.v, tree.base), omega = R * Vec3(angular_part(state.v, tree.base));
    V_0 << v, omega;
    A_0 << v.cross(omega), Vec3::Zero();
    base = base_columns(R, omega, v);
  }
  const std::vector<TreeAxis> axes = tree_axes(model, tree, state.g);
  std::vector<Column> columns;
  std::vector<Vec6> V, A;
  for (const TreeAxis& axis : axes) {
    const double rate = state.v[speed + axis.coordinate];
    const Vec6 &V_before = axis.parent < 0 ? V_0 : V[std::size_t(axis.parent)],
               &A_before = axis.parent < 0 ? A_0 : A[std::size_t(axis.parent)];
    const Vec6 turned = cross(V_before) * axis.screw;  // an axis does not move along itself: Psi = S'
    columns.push_back({axis.screw, 2 * turned, first + axis.coordinate});
    const Vec6 V_here = V_before + rate * axis.screw, A_here = A_before + rate * turned;
    V.push_back(V_here), A.push_back(A_here);
  }

  std::vector<Composite> carried(axes.size());
  Composite all;
  for (std::size_t k = axes.size(); k-- > 0;) {
    if (axes[k].link >= 0) {
      const BodyId body = tree.links[std::size_t(axes[k].link)].body;
      carried[k] += of_link(model.bodies[body], state.g[body], origin, model.gravity, V[k], A[k]);
    }
    (axes[k].parent < 0 ? all : carried[std::size_t(axes[k].parent)]) += carried[k];
    const Column& of = columns[k];
    out.gravity[of.place] = of.S.dot(carried[k].weight);
    out.gyroscopic[of.place] = -of.S.dot(carried[k].force);
    Pairs pairs(of, carried[k], out);
    for (int j = int(k); j >= 0; j = axes[std::size_t(j)].parent) pairs.add(columns[std::size_t(j)]);
    for (const Column& by : base) pairs.add(by);
  }
  out.turning.linear = all.force.head<3>();
  out.turning.angular = all.force.tail<3>() + origin.cross(out.turning.linear);
  for (const Column& of : base) {
    out.gravity[of.place] = of.S.dot(all.weight);
    out.gyroscopic[of.place] = -of.S.dot(all.force);
    Pairs pairs(of, all, out);
    for (const Column& by : base) pairs.add(by);
  }
  return out;
}

SparseMatrix tree_matrix(const TreeTerms& terms, const MatX& matrix, const Layout& dofs) {
  const int count = int(terms.velocity.size());
  SparseMatrix out(dofs.rows, dofs.rows);
  out.reserve(matrix.size());
  int column = 0;
  for (int j = 0; j < count; ++j) {
    const int at = row_of(dofs, terms.velocity[std::size_t(j)]);
    while (column <= at) out.startVec(column++);
    for (int i = 0; i < count; ++i)
      if (matrix(i, j) != 0) out.insertBack(row_of(dofs, terms.velocity[std::size_t(i)]), at) = matrix(i, j);
  }
  out.finalize();
  return out;
}

void add_tree_forces(const TreeTerms& terms, double scale, const Layout& dofs, VecX& gravity,
                     VecX& gyroscopic) {
  for (Eigen::Index i = 0; i < std::ssize(terms.velocity); ++i) {
    const int row = row_of(dofs, terms.velocity[std::size_t(i)]);
    gravity[row] += scale * terms.gravity[i];
    gyroscopic[row] += scale * terms.gyroscopic[i];
  }
}

namespace {

// What the twists of carried bodies are made of, each asked for when it is needed.
class Carriers {
 public:
  Carriers(const Model& model, const PerBody<SE3>& g) : model_(model), g_(g), known_(model.bodies.size()) {}
  bool carry(int velocity) const {
    const BodyId body = body_of(velocity);
    return body && is_carried(model_.bodies[body]);
  }
  const std::vector<TwistColumn>& columns(BodyId body) {
    if (known_[body].empty()) known_[body] = carried_columns(model_, g_, body);
    return known_[body];
  }
  // What an entry of State::v is made of: itself, if it is of no carried body.
  std::vector<std::pair<int, double>> parts(int velocity) {
    if (!carry(velocity)) return {{velocity, 1}};
    std::vector<std::pair<int, double>> out;
    for (const TwistColumn& c : columns(body_of(velocity)))
      out.emplace_back(c.velocity, c.twist[velocity % 6]);
    return out;
  }
  void add(int row, int column, double value, std::vector<Triplet>& matrix) {
    for (const auto& [i, a] : parts(row))
      for (const auto& [j, b] : parts(column)) matrix.emplace_back(i, j, a * value * b);
  }

 private:
  BodyId body_of(int velocity) const {
    return velocity < first_velocity(model_.bodies.next()) ? BodyId::at(velocity / 6) : BodyId();
  }

  const Model& model_;
  const PerBody<SE3>& g_;
  PerBody<std::vector<TwistColumn>> known_;
};

// The blocks of a matrix that couple carried bodies, as single entries; where it has them, nothing reads
// them.
void add_blocks(const ForceMatrix& m, Carriers& carriers, GeneralisedForce& force) {
  const BlockPattern& p = *m.pattern;
  for (int j = 0; j < int(p.entry.size()); ++j) {
    const int begin = p.begin[std::size_t(j)], height = p.begin[std::size_t(j) + 1] - begin;
    for (int k = 0; k < height; ++k) {
      const int row = m.first + p.entry[std::size_t(p.row[std::size_t(begin + k)])],
                column = m.first + p.entry[std::size_t(j)];
      if (!carriers.carry(row) && !carriers.carry(column)) continue;
      for (int b = 0; b < p.size; ++b)
        for (int a = 0; a < p.size; ++a) {
          const auto at = std::size_t(p.size * (p.size * begin + b * height + k) + a);
          carriers.add(row + a, column + b, m.K[at], force.K);
          if (!m.C.empty()) carriers.add(row + a, column + b, m.C[at], force.C);
        }
    }
  }
}

}  // namespace

void carry_forces(const Model& model, const PerBody<SE3>& g, GeneralisedForce& force) {
  if (!carries_bodies(model)) return;
  Carriers carriers(model, g);
  for (const BodyId b : model.bodies.ids()) {
    const Vec6 wrench = body_part(force.f, b);
    if (!is_carried(model.bodies[b]) || wrench.isZero(0)) continue;
    for (const TwistColumn& c : carriers.columns(b)) force.f[c.velocity] += c.twist.dot(wrench);
    body_part(force.f, b).setZero();
  }
  for (std::vector<Triplet>* matrix : {&force.K, &force.C}) {
    std::vector<Triplet> carried;
    for (const Triplet& e : *matrix) carriers.add(e.row(), e.col(), e.value(), carried);
    *matrix = std::move(carried);
  }
  for (const ForceMatrix& m : force.matrices) add_blocks(m, carriers, force);
}

}  // namespace aussois
