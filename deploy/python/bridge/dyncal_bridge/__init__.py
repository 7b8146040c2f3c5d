"""Hands live samples, results and states of dyncal on to Foxglove, MQTT and OPC UA; reads only."""
