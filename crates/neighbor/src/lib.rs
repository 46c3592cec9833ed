//! Cell grid, neighbor lists, displacement criterion and their brute-force twin
