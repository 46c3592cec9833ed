//! The scene file as typed tables, with errors that name file, line and key
