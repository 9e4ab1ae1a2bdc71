#pragma once

// What engines keep of a prepared scene in the cache, written and read by the same lines
// (model/cache/archive.h).

namespace palpate {

template <class Archive, class Partition>
void archive_partition(Archive& a, Partition& partition) {
  a(partition.grid);
  a(partition.brick_slot);
  a(partition.bricks);
  a(partition.mixed_brick);
  a(partition.boundary_place);
  a(partition.list_begin);
  a(partition.list_triangles);
  a(partition.has_internal);
}

template <class Archive, class Samples>
void archive_samples(Archive& a, Samples& samples) {
  a(samples.begin);
  a(samples.points);
  a(samples.entries);
  a(samples.owners);
  a(samples.words);
  a(samples.wide);
}

template <class Archive, class Tables>
void archive_tables(Archive& a, Tables& tables) {
  a(tables.boxes);
  a(tables.parts);
  a(tables.triangles.order);
  a(tables.triangles.boxes);
  a(tables.triangles.level_begin);
  a(tables.triangles.turned);
}

}  // namespace palpate
