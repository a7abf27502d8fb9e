/// Surfaces of OpenVDB volumes, meshed block by block. The one file that includes its tools: 15 s to compile.
///
/// The surface is that of openvdb::tools::volumeToMesh: dual, one vertex per sheet and cell, or per merged
/// region of cells. Merging never crosses an 8³ leaf node, and what a leaf gets depends on its neighbours
/// only, so a block of leaves meshed with a margin gives the very triangles that the whole grid would: no
/// seams to close, for any adaptivity. The whole-grid call does not tell which leaf a polygon is of; its
/// steps do, so these are called one by one. They are OpenVDB's internals, hence the check of its version.

#include <fmt/format.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <set>
#include <utility>
#include <vector>

#include "ooc/mapped_file.h"
#include "ooc/mesh_emitter.h"
#include "ooc/read_job.h"
#include "ooc/resident_pages.h"
#include "ooc/vdb_directory.h"

static_assert(OPENVDB_LIBRARY_MAJOR_VERSION_NUMBER == 10,
              "compare openvdb::tools::VolumeToMesh::operator() with BlockMesher before raising this");

namespace cuesta {
namespace {

namespace steps = openvdb::tools::volume_to_mesh_internal;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Index32;

constexpr std::int32_t leaf_voxels = 8;
constexpr std::int32_t farthest_voxel = std::int32_t{1} << 30;  // margins stay within 32 bits

/// A block with some leaves more before and after it.
CoordBBox with_margin(const CoordBBox& block, std::int32_t leaves_before, std::int32_t leaves_after) {
  return {block.min().offsetBy(-leaf_voxels * leaves_before),
          block.max().offsetBy(leaf_voxels * leaves_after)};
}

/// Releases what it charged.
class Charge {
 public:
  explicit Charge(ReadBudget& budget) : budget_(budget) {}
  Charge(const Charge&) = delete;
  Charge& operator=(const Charge&) = delete;
  ~Charge() { budget_.release(bytes_); }
  Result<void> add(std::uint64_t bytes, const char* what) {
    CUESTA_TRY(budget_.charge(bytes, 1, what));
    bytes_ += bytes;
    return {};
  }

 private:
  ReadBudget& budget_;
  std::uint64_t bytes_ = 0;
};

/// In an order that depends on the box alone. Without a ValueAccessor: that would load the leaves it finds.
template <class Tree, class Visit>
void for_leaves(Tree& tree, const CoordBBox& box, const Visit& visit) {
  using Parent = typename Tree::RootNodeType::ChildNodeType::ChildNodeType;
  const auto visit_within = [&](auto& parent, const CoordBBox& part) {
    for (Coord c = part.min(); c[0] <= part.max()[0]; c[0] += leaf_voxels)
      for (c[1] = part.min()[1]; c[1] <= part.max()[1]; c[1] += leaf_voxels)
        for (c[2] = part.min()[2]; c[2] <= part.max()[2]; c[2] += leaf_voxels)
          if (auto* leaf = parent.probeLeaf(c)) visit(*leaf);
  };
  constexpr std::int32_t step = Parent::DIM;
  const Coord first = box.min() & ~(step - 1);
  for (Coord c = first; c[0] <= box.max()[0]; c[0] += step)
    for (c[1] = first[1]; c[1] <= box.max()[1]; c[1] += step)
      for (c[2] = first[2]; c[2] <= box.max()[2]; c[2] += step)
        if (auto* parent = tree.root().template probeNode<Parent>(c)) {
          CoordBBox part = CoordBBox::createCube(c, step);
          part.intersect(box);
          visit_within(*parent, part);
        }
}

/// Leaf nodes whose values are loaded, and dropped again with this object. Nothing else may load them:
/// LeafBuffer::doLoad() that throws leaves a buffer marked as not loaded that owns values, where everyone
/// expects its place in the file. Here that happens to a copy.
template <class Leaf>
class BorrowedLeaves {
 public:
  using Buffer = typename Leaf::Buffer;

  BorrowedLeaves() = default;
  BorrowedLeaves(const BorrowedLeaves&) = delete;
  BorrowedLeaves& operator=(const BorrowedLeaves&) = delete;
  ~BorrowedLeaves() {
    for (std::size_t i = 0; i < unloaded_.size(); ++i)
      if (unloaded_[i]) leaves_[i]->swap(*unloaded_[i]);
  }
  void add(Leaf& leaf) {
    if (leaf.buffer().isOutOfCore()) leaves_.push_back(&leaf);
  }
  std::size_t size() const { return leaves_.size(); }
  /// @throw what OpenVDB throws; then some are loaded and some are not.
  void load() {
    unloaded_.resize(leaves_.size());
    tbb::parallel_for(std::size_t{0}, leaves_.size(), [this](std::size_t i) {
      auto loaded = std::make_unique<Buffer>(std::as_const(*leaves_[i]).buffer());
      try {
        static_cast<void>(std::as_const(*loaded).data());
      } catch (...) {
        static_cast<void>(loaded.release());  // never to be destroyed: 2 KiB
        throw;
      }
      leaves_[i]->swap(*loaded);
      unloaded_[i] = std::move(loaded);
    });
  }

 private:
  std::vector<Leaf*> leaves_;
  std::vector<std::unique_ptr<Buffer>> unloaded_;
};

/// world = origin + x·i + y·j + z·k, in f64.
struct Placement {
  Vec3d origin, x, y, z;

  Vec3d world(const openvdb::Vec3d& p) const { return origin + x * p[0] + y * p[1] + z * p[2]; }
  double determinant() const { return dot(cross(x, y), z); }
};

Vec3d as_vec(const openvdb::Vec3d& v) {
  return {v[0], v[1], v[2]};
}

Result<Placement> placement_of(const ReadJob& job, const openvdb::math::Transform& transform) {
  if (!transform.isLinear())
    return job.error(ErrorCode::unsupported_version, "",
                     fmt::format("the grid's transform is a {}; resample it with a linear one",
                                 transform.baseMap()->type()));
  const auto& map = *transform.baseMap();
  const Placement p{as_vec(map.applyMap({0, 0, 0})), as_vec(map.applyJacobian({1, 0, 0})),
                    as_vec(map.applyJacobian({0, 1, 0})), as_vec(map.applyJacobian({0, 0, 1}))};
  const double finite = p.determinant() + p.origin.x + p.origin.y + p.origin.z;
  if (!std::isfinite(finite) || p.determinant() == 0)
    return job.error(ErrorCode::invalid_input, "", "the grid's transform flattens it or is not finite");
  return p;
}

/// What one block gives: vertices in world coordinates, and polygons of its own leaves only.
struct BlockSurface {
  std::vector<Vec3d> positions;
  openvdb::tools::PolygonPoolList polygons;
  std::size_t pools = 0;
};

template <class Grid>
class BlockMesher {
  using Tree = typename Grid::TreeType;
  using Leaf = typename Tree::LeafNodeType;
  using Value = typename Tree::ValueType;
  using BoolTree = typename Tree::template ValueConverter<bool>::Type;
  using BoolLeaf = typename BoolTree::LeafNodeType;
  using SignTree = typename Tree::template ValueConverter<openvdb::Int16>::Type;
  using SignLeaf = typename SignTree::LeafNodeType;
  using PointTree = typename Tree::template ValueConverter<Index32>::Type;
  using PointLeaf = typename PointTree::LeafNodeType;
  using Range = tbb::blocked_range<std::size_t>;

 public:
  BlockMesher(Grid& grid, const Placement& placement, Value iso, double adaptivity, ReadBudget& budget)
      : grid_(grid),
        tree_(grid.tree()),
        placement_(placement),
        iso_(iso),
        adaptivity_(static_cast<float>(adaptivity)),
        is_dense_inside_(grid.getGridClass() != openvdb::GRID_LEVEL_SET),
        budget_(budget) {
    offsets_.template constructOffsetList<Leaf>();
    steps::maskActiveTileBorders(std::as_const(tree_), iso_, tile_borders_);
  }

  std::uint64_t tile_border_bytes() const { return tile_borders_.memUsage(); }

  /// Lowest voxels of all blocks that may have triangles: of leaves, of borders of tiles, and of the leaves
  /// before them, where their lowest edges begin.
  std::set<Coord> blocks(std::int32_t block_voxels) const {
    std::set<Coord> found;
    Coord previous = Coord::max();
    const auto add = [&](const Coord& origin) {
      const auto block = [&](std::int32_t v) {
        return v - ((v % block_voxels) + block_voxels) % block_voxels;
      };
      const auto low = [&](std::int32_t v) { return block(v - leaf_voxels); };
      const Coord at(block(origin[0]), block(origin[1]), block(origin[2]));
      const Coord before(low(origin[0]), low(origin[1]), low(origin[2]));
      if (at == before && at == previous) return;
      for (int corner = 0; corner < 8; ++corner)
        found.insert(
            {(corner & 1 ? before : at)[0], (corner & 2 ? before : at)[1], (corner & 4 ? before : at)[2]});
      previous = at;
    };
    for (auto leaf = std::as_const(tree_).cbeginLeaf(); leaf; ++leaf) add(leaf->origin());
    for (auto leaf = tile_borders_.cbeginLeaf(); leaf; ++leaf) add(leaf->origin());
    return found;
  }

  /// @throw what OpenVDB throws. @error out_of_budget.
  /// A polygon belongs to the leaf of its edge's lower voxel, so it has vertices in cells of that leaf and
  /// the leaf before; merging in that one looks at whether cells of a second leaf before have a surface;
  /// which cells have one is known from edges up to one leaf after. Signs and gradients reach a voxel
  /// further.
  Result<BlockSurface> mesh(const CoordBBox& block) {
    Charge charge(budget_);
    BorrowedLeaves<Leaf> borrowed;
    const std::vector<const Leaf*> leaves = borrow(block, borrowed);
    if (leaves.empty() && tile_borders_.empty()) return BlockSurface{};
    CUESTA_TRY(charge.add(borrowed.size() * (Leaf::SIZE * sizeof(Value) + 512), "voxels of a block"));
    borrowed.load();

    SignTree signs(0);
    PointTree points(std::numeric_limits<Index32>::max());
    find_cells(block, leaves, signs, points);
    Cells cells(signs, points, with_margin(block, 1, 0));
    CUESTA_TRY(charge.add(signs.memUsage() + points.memUsage(), "cells of a block"));
    if (adaptivity_ > 0) merge(points, cells);
    BlockSurface surface;
    const std::size_t vertices = count(cells);
    CUESTA_TRY(charge.add(vertices * (sizeof(openvdb::Vec3s) + sizeof(Vec3d) + sizeof(std::uint32_t) + 40),
                          "vertices of a block"));
    place(cells, vertices, surface);
    connect(block, cells, signs, points, surface);
    return surface;
  }

  /// Lowest and highest active value, for a message.
  std::pair<double, double> value_range() {
    std::pair range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    const auto widen = [&](double v) {
      if (v < range.first) range.first = v;
      if (v > range.second) range.second = v;
    };
    for (auto leaf = tree_.beginLeaf(); leaf; ++leaf) {
      BorrowedLeaves<Leaf> borrowed;
      borrowed.add(*leaf);
      borrowed.load();
      for (auto value = leaf->cbeginValueOn(); value; ++value) widen(static_cast<double>(*value));
    }
    auto tile = std::as_const(tree_).cbeginValueOn();
    tile.setMaxDepth(Tree::ValueOnCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) widen(static_cast<double>(*tile));
    return range;
  }

 private:
  /// The leaves of cells, in the order of the tree.
  struct Cells {
    Cells(SignTree& signs, PointTree& points, const CoordBBox& box) {
      std::vector<SignLeaf*> all_signs;
      std::vector<PointLeaf*> all_points;
      signs.getNodes(all_signs);
      points.getNodes(all_points);
      for (std::size_t i = 0; i < all_signs.size(); ++i) {
        if (!box.isInside(all_signs[i]->origin())) continue;
        sign_leaves.push_back(all_signs[i]);
        point_leaves.push_back(all_points[i]);
      }
      first_point = std::make_unique<Index32[]>(sign_leaves.size() + 1);
    }
    Range range() const { return {0, sign_leaves.size()}; }

    std::vector<SignLeaf*> sign_leaves;
    std::vector<PointLeaf*> point_leaves;
    std::unique_ptr<Index32[]> first_point;  // of each leaf, and the number of all
  };

  /// @return the leaves whose edges decide which cells of the block have a surface.
  std::vector<const Leaf*> borrow(const CoordBBox& block, BorrowedLeaves<Leaf>& borrowed) {
    std::vector<const Leaf*> leaves;
    const CoordBBox deciding = with_margin(block, 2, 1);
    const CoordBBox touched = with_margin(block, 3, 2);
    for_leaves(tree_, touched, [&](Leaf& leaf) {
      borrowed.add(leaf);
      if (deciding.isInside(leaf.origin())) leaves.push_back(&leaf);
    });
    return leaves;
  }

  void find_cells(const CoordBBox& block, const std::vector<const Leaf*>& leaves, SignTree& signs,
                  PointTree& points) {
    BoolTree crossed(false);
    steps::IdentifyIntersectingVoxels<Tree> cross(tree_, leaves, offsets_, crossed, iso_);
    tbb::parallel_reduce(Range(0, leaves.size()), cross);
    const CoordBBox wanted = with_margin(block, 2, 0);
    if (!tile_borders_.empty()) {
      for_leaves(tile_borders_, wanted,
                 [&](const BoolLeaf& leaf) { crossed.touchLeaf(leaf.origin())->topologyUnion(leaf); });
    }

    std::vector<const BoolLeaf*> cells;
    crossed.getNodes(cells);
    std::erase_if(cells, [&](const BoolLeaf* leaf) { return !wanted.isInside(leaf->origin()); });
    steps::ComputeAuxiliaryData<Tree> compute(tree_, cells, signs, points, iso_);
    tbb::parallel_reduce(Range(0, cells.size()), compute);
  }

  void merge(const PointTree& points, const Cells& cells) const {
    const steps::MergeVoxelRegions<Grid> op(grid_, points, cells.point_leaves, cells.sign_leaves, iso_,
                                            adaptivity_, is_dense_inside_);
    tbb::parallel_for(cells.range(), op);
  }

  std::size_t count(Cells& cells) const {
    if (adaptivity_ > 0) {
      tbb::parallel_for(cells.range(), steps::AdaptiveLeafNodePointCount<PointLeaf>(
                                           cells.point_leaves, cells.sign_leaves, cells.first_point));
    } else {
      tbb::parallel_for(cells.range(),
                        steps::LeafNodePointCount<SignLeaf::LOG2DIM>(cells.sign_leaves, cells.first_point));
    }
    Index32 before = 0;
    for (std::size_t i = 0; i <= cells.sign_leaves.size(); ++i)
      before += std::exchange(cells.first_point[i], before);
    return cells.first_point[cells.sign_leaves.size()];
  }

  /// OpenVDB rounds positions to float. Relative to their leaf node that costs 2^-21 of a voxel, wherever the
  /// node lies, and every block that computes a vertex gets the same bits.
  void place(const Cells& cells, std::size_t vertices, BlockSurface& surface) const {
    using openvdb::math::TranslationMap;
    std::vector<openvdb::Vec3s> local(vertices);
    surface.positions.resize(vertices);
    tbb::parallel_for(cells.range(), [&](const Range& range) {
      for (std::size_t n = range.begin(); n != range.end(); ++n) {
        const openvdb::Vec3d origin = cells.sign_leaves[n]->origin().asVec3d();
        const openvdb::math::Transform to_leaf(openvdb::math::MapBase::Ptr(new TranslationMap(-origin)));
        const steps::ComputePoints<Tree> compute(local.data(), tree_, cells.point_leaves, cells.sign_leaves,
                                                 cells.first_point, to_leaf, static_cast<double>(iso_));
        compute(Range(n, n + 1));
        for (Index32 i = cells.first_point[n]; i < cells.first_point[n + 1]; ++i)
          surface.positions[i] = placement_.world(origin + openvdb::Vec3d(local[i]));
      }
    });
  }

  void connect(const CoordBBox& block, const Cells& cells, const SignTree& signs, const PointTree& points,
               BlockSurface& surface) const {
    std::vector<SignLeaf*> own = cells.sign_leaves;
    std::erase_if(own, [&](const SignLeaf* leaf) { return !block.isInside(leaf->origin()); });
    surface.pools = own.size();
    surface.polygons.reset(new openvdb::tools::PolygonPool[own.size()]);
    const Range range(0, own.size());
    if (adaptivity_ > 0) {
      tbb::parallel_for(range, steps::ComputePolygons<SignTree, steps::AdaptivePrimBuilder>(
                                   own, signs, points, surface.polygons, is_dense_inside_));
    } else {
      tbb::parallel_for(range, steps::ComputePolygons<SignTree, steps::UniformPrimBuilder>(
                                   own, signs, points, surface.polygons, is_dense_inside_));
    }
  }

  Grid& grid_;
  Tree& tree_;
  Placement placement_;
  Value iso_;
  float adaptivity_;
  bool is_dense_inside_;  // as in fog; the inside of a level set is below the iso value
  ReadBudget& budget_;
  steps::LeafNodeVoxelOffsets offsets_;
  BoolTree tile_borders_{false};
};

/// Blocks into the sink; vertices that no polygon of the block uses are left out.
class SurfaceOut {
 public:
  SurfaceOut(const ReadJob& job, bool is_mirrored) : out_(job, {}), is_mirrored_(is_mirrored) {
    out_.set_vertex_count(std::numeric_limits<std::uint64_t>::max());
  }

  Result<void> add(const BlockSurface& surface) {
    surface_ = &surface;
    number_.assign(surface.positions.size(), 0);
    first_ = next_;
    for (std::size_t n = 0; n < surface.pools; ++n) {
      const openvdb::tools::PolygonPool& pool = surface.polygons[n];
      for (std::size_t i = 0; i < pool.numQuads(); ++i) CUESTA_TRY(quad(pool.quad(i)));
      for (std::size_t i = 0; i < pool.numTriangles(); ++i) {
        const auto& t = pool.triangle(i);
        CUESTA_TRY(triangle(t[0], t[1], t[2]));
      }
    }
    return {};
  }
  void at_byte(std::uint64_t byte) { out_.at_byte(byte); }
  Result<ReadReport> finish() { return out_.finish(); }
  bool is_empty() const { return next_ == 0; }

 private:
  /// Along its shorter diagonal, which keeps needles out of stretched quads.
  Result<void> quad(const openvdb::Vec4I& q) {
    const auto& p = surface_->positions;
    const Vec3d d02 = p[q[2]] - p[q[0]], d13 = p[q[3]] - p[q[1]];
    if (dot(d13, d13) < dot(d02, d02)) {
      CUESTA_TRY(triangle(q[0], q[1], q[3]));
      return triangle(q[1], q[2], q[3]);
    }
    CUESTA_TRY(triangle(q[0], q[1], q[2]));
    return triangle(q[0], q[2], q[3]);
  }

  /// OpenVDB's polygons are clockwise seen from outside; a mirroring transform has turned them already.
  Result<void> triangle(Index32 a, Index32 b, Index32 c) {
    std::uint64_t ia = 0, ib = 0, ic = 0;
    CUESTA_TRY(vertex(a, ia));
    CUESTA_TRY(vertex(b, ib));
    CUESTA_TRY(vertex(c, ic));
    return is_mirrored_ ? out_.triangle(ia, ib, ic) : out_.triangle(ia, ic, ib);
  }
  Result<void> vertex(Index32 i, std::uint64_t& index) {
    if (number_[i] == 0) {
      number_[i] = static_cast<std::uint32_t>(++next_ - first_);
      CUESTA_TRY(out_.vertex({surface_->positions[i], {}}));
    }
    index = first_ + number_[i] - 1;
    return {};
  }

  MeshEmitter out_;
  bool is_mirrored_;
  const BlockSurface* surface_ = nullptr;
  std::vector<std::uint32_t> number_;  // of a vertex in its block, from 1; 0: not sent
  std::uint64_t first_ = 0, next_ = 0;
};

Result<double> iso_of(const ReadJob& job, const openvdb::GridBase& grid) {
  if (job.volume.iso) return *job.volume.iso;
  if (grid.getGridClass() == openvdb::GRID_LEVEL_SET) return 0.0;
  if (grid.getGridClass() == openvdb::GRID_FOG_VOLUME) return 0.5;
  return job.error(ErrorCode::invalid_input, "",
                   fmt::format("grid {} is marked neither as a level set nor as a fog volume: say with --iso "
                               "which value its surface has",
                               quote_word(grid.getName())));
}

Result<void> check_extent(const ReadJob& job, const openvdb::GridBase& grid) {
  const CoordBBox box = grid.evalActiveVoxelBoundingBox();
  if (box.empty()) return job.error(ErrorCode::invalid_input, "", "the grid is empty: no voxel is active");
  for (int axis = 0; axis < 3; ++axis)
    if (box.min()[axis] < -farthest_voxel || box.max()[axis] > farthest_voxel)
      return job.error(ErrorCode::invalid_input, "", "the grid has voxels beyond 2^30 of its origin");
  return {};
}

template <class Grid>
Result<ReadReport> read_surface(const ReadJob& job, Grid& grid, const VdbGrid& entry) {
  const auto iso = iso_of(job, grid);
  if (!iso) return fail(iso.error());
  const auto placement = placement_of(job, grid.transform());
  if (!placement) return fail(placement.error());
  Charge charge(job.budget);
  BlockMesher<Grid> mesher(grid, *placement, static_cast<typename Grid::ValueType>(*iso),
                           job.volume.adaptivity, job.budget);
  const std::int32_t edge = job.volume.block_voxels;
  const std::set<Coord> blocks = mesher.blocks(edge);
  CUESTA_TRY(charge.add(mesher.tile_border_bytes() + 64 * blocks.size(), "blocks of a volume"));
  SurfaceOut out(job, placement->determinant() < 0);
  const std::uint64_t values = entry.end_byte - entry.values_byte;
  for (std::uint64_t done = 0; const Coord& at : blocks) {
    auto surface = mesher.mesh(CoordBBox::createCube(at, edge));
    if (!surface) return fail(std::move(surface).error());
    forget_resident_pages(job.path);
    out.at_byte(entry.values_byte +
                static_cast<std::uint64_t>(static_cast<double>(values) * static_cast<double>(++done) /
                                           static_cast<double>(blocks.size())));
    CUESTA_TRY(out.add(*surface));
  }
  if (!out.is_empty()) return out.finish();
  const auto [low, high] = mesher.value_range();
  return job.error(ErrorCode::invalid_input, "",
                   fmt::format("grid {} has no surface of value {}: its active values go from {} to {}; give "
                               "one between with --iso",
                               quote_word(grid.getName()), *iso, low, high));
}

Result<ReadReport> read_grid(const ReadJob& job, const VdbGrid& entry) {
  openvdb::initialize();
  openvdb::io::File file(job.path.string());
  file.setCopyMaxBytes(0);  // else it is copied to TMPDIR first
  file.open(/*delayLoad=*/true);
  Charge charge(job.budget);
  // Nodes are about four times what their masks are in the file; what they really are is known afterwards.
  CUESTA_TRY(charge.add(4 * (entry.values_byte - entry.topology_byte), "nodes of a volume"));
  const openvdb::GridBase::Ptr grid = file.readGrid(entry.name);
  Charge nodes(job.budget);
  const std::uint64_t expected = 4 * (entry.values_byte - entry.topology_byte);
  if (grid->memUsage() > expected) CUESTA_TRY(nodes.add(grid->memUsage() - expected, "nodes of a volume"));
  CUESTA_TRY(check_extent(job, *grid));
  if (auto floats = openvdb::GridBase::grid<openvdb::FloatGrid>(grid))
    return read_surface(job, *floats, entry);
  if (auto doubles = openvdb::GridBase::grid<openvdb::DoubleGrid>(grid))
    return read_surface(job, *doubles, entry);
  return job.error(ErrorCode::corrupt, "", fmt::format("grid {} is not what its header says", entry.name));
}

Result<void> check_options(const ReadJob& job) {
  const VolumeOptions& o = job.volume;
  if (!(o.adaptivity >= 0 && o.adaptivity <= 1))
    return job.error(ErrorCode::invalid_input, "", "--adaptivity is a number from 0 to 1");
  if (o.iso && !std::isfinite(*o.iso))
    return job.error(ErrorCode::invalid_input, "", "--iso is a finite number");
  if (o.block_voxels < leaf_voxels || o.block_voxels % leaf_voxels != 0 || o.block_voxels > 4096)
    return job.error(ErrorCode::invalid_input, "", "blocks are 8 to 4096 voxels wide, in steps of 8");
  return {};
}

/// OpenVDB opens the file by its name; what was unpacked has none.
Result<void> check_is_the_file(const ReadJob& job) {
  const auto file = MappedFile::open(job.path);
  if (file && is_vdb(file->bytes())) return {};
  return job.error(ErrorCode::unsupported_version, "",
                   "a volume inside gzip or Zstandard is not read in place: unpack it first. (.vdb files are "
                   "compressed inside)");
}

Result<ReadReport> read_guarded(const ReadJob& job, const VdbGrid& entry) {
  try {
    return read_grid(job, entry);
  } catch (const std::bad_alloc&) {
    return job.error(ErrorCode::out_of_budget, "", "the system has no memory left");
  } catch (const std::exception& e) {
    return job.corrupt_at(entry.topology_byte,
                          fmt::format("grid {} cannot be read: {}", quote_word(entry.name), e.what()));
  }
}

}  // namespace

Result<ReadReport> read_vdb(const ReadJob& job) {
  CUESTA_TRY(check_options(job));
  CUESTA_TRY(job.report_progress(0));
  const auto grids = read_vdb_directory(job);
  if (!grids) return fail(grids.error());
  const auto entry = choose_vdb_grid(job, *grids, job.volume.grid);
  if (!entry) return fail(entry.error());
  CUESTA_TRY(check_is_the_file(job));
  const ForeignMapGuard guard;  // OpenVDB maps the file for itself
  auto report = read_guarded(job, *entry);
  if (!guard.has_faulted() || (!report && report.error().code == ErrorCode::cancelled)) return report;
  if (job.file) CUESTA_TRY(job.file->check_unchanged());
  return job.error(ErrorCode::io, "", "a part of the file could not be read from its disk");
}

}  // namespace cuesta
