//! Initial conditions, the main loop, schedule, watchdog, timers and plan
