// Whole tables of a store, each row checked; for store_content and store_world.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/store_table.hpp"

namespace povslam {

// Reads a whole table into `rows`; `read` makes a row of number and bytes, and fault_in(row, meta) judges it.
template <class Row, class Meta, class Read>
void read_table(Database& database, Table table, const Manifest& manifest, const Meta& meta, Read&& read,
                std::vector<Row>& rows) {
  TableReader reader(database, table);
  while (reader.next()) {
    std::optional<Row> row = read(reader.id(), reader.data());
    if (!row) {
      database.fail_damaged(std::string("table ") + name_of(table) + ", row " + std::to_string(reader.id()) +
                            ": its layout is unknown");
    }
    if (const auto fault = fault_in(*row, meta)) database.fail_damaged(*fault);
    rows.push_back(std::move(*row));
  }
  reader.check_total(manifest);
}

inline void check_table(Database& database, Table table, const Manifest& manifest) {
  TableReader reader(database, table);
  while (reader.next()) {
  }
  reader.check_total(manifest);
}

}  // namespace povslam
