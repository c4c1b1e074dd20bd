"""Critical depths from the growth rate of small vibration in simulated cuts."""
