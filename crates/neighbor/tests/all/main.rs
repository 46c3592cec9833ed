//! Tests of neighbor lists from outside, against the brute-force search.

mod lists;
