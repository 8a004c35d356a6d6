#pragma once

#include <fstream>
#include <mutex>
#include <string>
#include <vector>

#include "host/campaign/family.h"
#include "host/campaign/metrics.h"

namespace sidestep::campaign {

/// One trial: the scene (family and seed), the law that controlled the arm, and the result.
struct Row {
  const Family* family = nullptr;
  std::string law;
  uint64_t seed = 0;
  TrialMetrics metrics;
};

/// Columns that only files with families of people, of furniture or with posture goals have; other families leave them
/// at nan there.
struct MoreColumns {
  bool people = false, furniture = false, posture = false;

  void include(const Family& family) {
    people = people || family.has_people();
    furniture = furniture || family.has_furniture();
    posture = posture || family.posture;
  }
};

/// Writes trials as they end, a line each. Written numbers are read back as the same bits. All functions throw
/// std::runtime_error, one line with the file.
class CsvWriter {
 public:
  /// Replaces the file by one with these rows, at once: until they are all written, beside it, it stays as it is.
  CsvWriter(const std::string& file, MoreColumns more, const std::vector<Row>& rows = {});

  /// May be called from several threads.
  void add(const Row& row);

 private:
  void write(const Row& row);
  void flush();

  std::string file_;
  MoreColumns more_;
  std::ofstream stream_;
  std::mutex mutex_;
};

/// With the columns that the rows' families need.
void write_csv(const std::string& file, const std::vector<Row>& rows);

/// A last line without end, whose number may be cut short, is an error.
std::vector<Row> read_csv(const std::string& file);

/// The same of a file whose writer may have been killed: such a line is ignored.
std::vector<Row> read_interrupted_csv(const std::string& file);

/// Whether two rows of the same trial are equal, CPU times excepted.
bool same_result(const Row& a, const Row& b);

/// Sorts by law, family (in the order of the tables) and seed. Throws std::runtime_error if a trial occurs twice.
void sort_rows(std::vector<Row>& rows);

}  // namespace sidestep::campaign
