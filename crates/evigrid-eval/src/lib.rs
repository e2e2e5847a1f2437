//! The run loop, its plan, results folder, tables, and map files.
